"""Manifests of the packages that tools/board_packages made, by the programs that read them, as far as these are installed.
   manifests.py FOLDER [PACK.xsd]"""
import importlib.util
import json
import pathlib
import sys
import xml.etree.ElementTree as xml

folder = pathlib.Path(sys.argv[1])


def have(module, what):
    found = importlib.util.find_spec(module) is not None
    print(f"{what}: {'read by' if found else 'not read, without'} {module}")
    return found


fields = dict(line.split("=", 1) for line in (folder / "libdyn/library.properties").read_text().splitlines())
missing = {"name", "version", "author", "maintainer", "sentence", "paragraph", "category", "url", "architectures"} - fields.keys()
assert not missing, f"library.properties: without {missing}"
assert json.loads((folder / "libdyn/library.json").read_text())["version"] == fields["version"]

description = folder / "cmsis/libdyn.libdyn.pdsc"
pack = xml.parse(description).getroot()
absent = [f.get("name") for f in pack.iter("file") if not (folder / "cmsis" / f.get("name")).exists()]
assert not absent, f"the pack lacks {absent}"
conditions = {c.get("id") for c in pack.iter("condition")}
assert {f.get("condition") for f in pack.iter("file")} - {None} <= conditions
if len(sys.argv) > 2 and have("lxml", "libdyn.libdyn.pdsc and PACK.xsd"):
    from lxml import etree

    etree.XMLSchema(etree.parse(sys.argv[2])).assertValid(etree.parse(str(description)))

if have("yaml", "module.yml"):
    import yaml

    module = yaml.safe_load((folder / "zephyr/zephyr/module.yml").read_text())
    for name in (module["build"]["kconfig"], module["samples"][0]):
        assert (folder / "zephyr" / name).exists(), name
if have("kconfiglib", "Kconfig"):
    import kconfiglib

    # a Zephyr that has a Cortex-M7 with an FPU
    root = folder / "Kconfig.test"
    zephyr = "config FP_HARDABI\n\tdef_bool y\nconfig CPU_CORTEX_M7\n\tdef_bool y\nconfig REQUIRES_FULL_LIBC\n\tbool\n"
    root.write_text(zephyr + (folder / "zephyr/Kconfig").read_text())
    try:
        symbols = kconfiglib.Kconfig(str(root)).syms
    finally:
        root.unlink()
    symbols["DYN"].set_value("y")
    assert symbols["DYN"].str_value == "y" and symbols["REQUIRES_FULL_LIBC"].str_value == "y"
