"""Pages in a real browser, without a screen: those of the command as it is built, and those that Debian's packages make.

DYN_CLI: the command; DYN_MODELS_DIR: models/. Skipped where there is no chromium, no playwright, or none of those packages
(tools/packages_page).
"""

import os
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
MODELS = Path(os.environ.get("DYN_MODELS_DIR", ROOT / "models"))
BUILT = Path(os.environ.get("DYN_CLI", ROOT / "build/release/bin/dyn")).resolve()
BROWSERS = ("chromium-headless-shell", "chromium", "google-chrome")


@pytest.fixture(scope="session", autouse=True, params=["as built", "of Debian's packages"])
def bundle(request, tmp_path_factory):
    """Which page the command fills: its own, or, in a copy of it, that of Debian's packages."""
    dyn.command = BUILT
    if request.param == "as built":
        return
    copy = tmp_path_factory.mktemp("debian")
    page = copy / "share/dyn/viewer.html"
    made = subprocess.run([ROOT / "tools/viewer/bundle", "--debian", copy / "work", page], capture_output=True, text=True,
                          check=True)
    if not page.exists():
        pytest.skip(made.stderr)
    (copy / "bin").mkdir()
    (copy / "lib").symlink_to(BUILT.parents[1] / "lib")
    dyn.command = shutil.copy(BUILT, copy / "bin/dyn")


def dyn(*arguments, **options):
    return subprocess.run([dyn.command, *map(str, arguments)], capture_output=True, text=True, timeout=1200, **options)


@pytest.fixture(scope="session")
def browser():
    api = pytest.importorskip("playwright.sync_api", reason="no browser tests: python package playwright is missing")
    found = next(filter(None, map(shutil.which, BROWSERS)), None)
    if not found:
        pytest.skip("no browser tests: chromium is missing (Debian: chromium-headless-shell)")
    with api.sync_playwright() as playwright:
        # WebGL by software, so that pixels are the same on every machine
        browser = playwright.chromium.launch(executable_path=found, args=["--use-angle=swiftshader",
                                                                          "--enable-unsafe-swiftshader"])
        yield browser
        browser.close()


class Page:
    """A page, what it complained of, and what it asked of the network."""

    def __init__(self, page):
        self.page, self.complaints, self.requests = page, [], []
        page.set_default_timeout(300_000)  # ms: a page draws as fast as the machine lets it
        page.on("console", lambda message: self.complaints.append(message.text)
                if message.type in ("error", "warning") and "GPU stall" not in message.text else None)
        page.on("pageerror", lambda error: self.complaints.append(str(error)))
        page.on("request", lambda request: self.requests.append(request.url)
                if not request.is_navigation_request() and not request.url.startswith(("data:", "blob:")) else None)

    def open(self, address):
        self.page.goto(address)
        self.page.wait_for_function("window.dynView && window.dynView.scene.drawn > 0")
        return self

    def __call__(self, script):
        return self.page.evaluate(script)

    def settle(self):
        """Until two more pictures could be drawn."""
        self.page.evaluate("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => "
                           "requestAnimationFrame(done))))")

    def changed(self, script):
        """How much of the 3D picture, 0 to 1, changes by what the script does."""
        self.settle()
        return self.page.evaluate(
            """async (script) => {
            const canvas = document.getElementById("canvas"), scene = window.dynView.scene;
            const picture = () => {
              scene.redraw(), scene.draw();
              const flat = new OffscreenCanvas(canvas.width, canvas.height).getContext("2d");
              flat.drawImage(canvas, 0, 0);
              return flat.getImageData(0, 0, canvas.width, canvas.height).data;
            };
            const before = picture();
            (0, eval)(script);
            const after = picture();
            let n = 0;
            for (let i = 0; i < before.length; i += 4) n += Math.abs(before[i] - after[i]) + Math.abs(before[i + 1] - after[i + 1]) + Math.abs(before[i + 2] - after[i + 2]) > 30;
            return (4 * n) / before.length; }""",
            script,
        )


@pytest.fixture
def page(browser):
    # pages allow no eval, which these tests use
    context = browser.new_context(viewport={"width": 800, "height": 500}, bypass_csp=True)
    yield Page(context.new_page())
    context.close()
