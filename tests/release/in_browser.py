"""A page that simulates by itself, in a browser without a screen: time passes, the quadruped stands, a push moves it, and nothing is asked of
the network.   in_browser.py PAGE"""

import shutil
import sys
import time
from pathlib import Path

from playwright.sync_api import sync_playwright

BROWSERS = ("chromium-headless-shell", "chromium", "google-chrome")
HEIGHT = "dynSimulation.data.q[2]"


def wait(page, what, seconds=120):
    end = time.monotonic() + seconds
    while not page.evaluate(f"Boolean({what})"):
        assert time.monotonic() < end, f"{what} did not come true; the page says: {page.inner_text('#message')}"
        time.sleep(0.1)


def main(file):
    found = next(filter(None, map(shutil.which, BROWSERS)))
    with sync_playwright() as api:
        browser = api.chromium.launch(executable_path=found, args=["--use-angle=swiftshader", "--enable-unsafe-swiftshader"])
        page, complaints, requests = browser.new_page(), [], []
        page.on("console", lambda m: complaints.append(m.text) if m.type == "error" else None)
        page.on("pageerror", lambda e: complaints.append(str(e)))
        page.on("request", lambda r: requests.append(r.url) if not r.url.startswith(("file:", "data:", "blob:")) else None)
        page.goto(Path(file).resolve().as_uri())
        wait(page, "globalThis.dynSimulation && dynSimulation.time > 0.2")
        start, height = page.evaluate("dynSimulation.time"), page.evaluate(HEIGHT)
        wait(page, f"dynSimulation.time > {start} + 0.5")
        assert abs(page.evaluate(HEIGHT) - height) < 0.02, "it does not stand"
        page.click("#pause")
        wait(page, "dynSimulation.paused")
        clock = page.inner_text("#clock")
        page.screenshot(path=str(Path(file).with_suffix(".png")))
        browser.close()
    assert not complaints and not requests, (complaints, requests)
    print(f"{clock}: the trunk is {height:.3f} m up")


if __name__ == "__main__":
    main(sys.argv[1])
