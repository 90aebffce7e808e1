#!/usr/bin/env python3
"""Takes a picture of a report as a browser shows it, the vertex closest to the implant pinned: docs/report.png.

screenshot.py REPORT.html OUT.png needs Chromium with its driver, and Debian's python3-selenium.
"""
import shutil
import sys
from pathlib import Path

from selenium import webdriver
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.by import By
from selenium.webdriver.support.wait import WebDriverWait

size = (1500, 950)


def headless_browser():
    chrome = webdriver.ChromeOptions()
    for argument in ["--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--hide-scrollbars",
                     "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]:
        chrome.add_argument(argument)
    return webdriver.Chrome(service=Service(shutil.which("chromedriver")), options=chrome)


def take(report, picture):
    with headless_browser() as browser:
        browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {
            "width": size[0], "height": size[1], "deviceScaleFactor": 1, "mobile": False})
        browser.get(Path(report).resolve().as_uri())
        page = browser.find_element(By.TAG_NAME, "body")
        WebDriverWait(browser, 60).until(lambda _: "ready" in page.get_attribute("class").split())
        browser.find_element(By.XPATH, "//button[text()='closest']").click()
        browser.execute_async_script("requestAnimationFrame(() => requestAnimationFrame(arguments[0]))")
        browser.save_screenshot(str(picture))


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    take(*sys.argv[1:])
