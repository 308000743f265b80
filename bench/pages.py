"""Where the measured tables go: README.md and the pages of capi/pages, between <!-- bench NAME --> and <!-- /bench -->."""

import re
from pathlib import Path

PROJECT = Path(__file__).resolve().parent.parent


def write(name, text):
    """The text between the table's markers, in the page that has them."""
    pattern = re.compile(rf"(<!-- bench {name} -->\n).*?(<!-- /bench -->)", re.S)
    for page in [PROJECT / "README.md", *sorted((PROJECT / "capi/pages").glob("*.md"))]:
        content = page.read_text(encoding="utf-8")
        if pattern.search(content):
            page.write_text(pattern.sub(lambda m: m[1] + text.rstrip("\n") + "\n" + m[2], content), encoding="utf-8")
            return page
    raise RuntimeError(f"neither README.md nor a page of capi/pages has <!-- bench {name} --> ... <!-- /bench -->")
