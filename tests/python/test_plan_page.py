"""The page of a plan in a real browser: it plays, seeks, and shows who violates what.

The pages are those of `cargo build --release --example plan_page`, which `make check` builds; skipped without them, and
without a browser as the page of a mission is.
"""

import json
import math
import subprocess
from pathlib import Path

import pytest
from example_log import ROOT

selenium = pytest.importorskip("selenium")
from selenium.webdriver.common.by import By  # noqa: E402
from test_page import browser, press, pytestmark as needs_browser, set_slider, state, wait_for  # noqa: E402, F401

EXAMPLE = ROOT / "target" / "release" / "examples" / "plan_page"
pytestmark = [needs_browser, pytest.mark.skipif(not EXAMPLE.exists(), reason="the example plan_page is not built")]


@pytest.fixture(scope="module")
def pages(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("plans")
    subprocess.run([EXAMPLE, folder], check=True)
    return folder


@pytest.fixture(params=["grid", "cars"])
def page(request, browser, pages):  # noqa: F811
    """Each page, freshly opened from disk; checks at the end that it complained about nothing and fetched nothing."""
    browser.get("about:blank")
    for log in ("browser", "performance"):
        browser.get_log(log)
    uri = (pages / f"{request.param}.html").as_uri()
    browser.get(uri)
    browser.plan = request.param
    yield browser
    assert browser.get_log("browser") == []
    messages = [json.loads(entry["message"])["message"] for entry in browser.get_log("performance")]
    requests = [m["params"]["request"]["url"] for m in messages if m["method"] == "Network.requestWillBeSent"]
    assert [url for url in requests if not url.startswith(("data:", "chrome://"))] == [uri]


def test_every_body_goes_from_its_start_to_its_goal(page):
    goals = page.execute_script("return JSON.parse(document.getElementById('replay').textContent).robots.map(r => r.goal)")
    start = state(page)
    assert start["time"] == 0 and not start["playing"] and len(start["robots"]) == len(goals) > 0
    press(page, "\ue010")  # End
    drawn = state(page)
    assert drawn["time"] == drawn["duration"]
    for robot, (x, y, yaw) in zip(drawn["robots"], goals, strict=True):
        # poses are stored in steps of 0.1 mm and 0.1 mrad
        assert math.hypot(robot["x"] - x, robot["y"] - y) < 1e-3
        assert abs(math.remainder(robot["yaw"] - yaw, math.tau)) < 1e-3
    assert any(math.dist((a["x"], a["y"]), (b["x"], b["y"])) > 1 for a, b in zip(start["robots"], drawn["robots"]))


def test_it_plays_to_the_end(page):
    set_slider(page, state(page)["duration"] - 1)
    page.find_element(By.ID, "play").click()
    drawn = wait_for(page, lambda s: not s["playing"])
    assert drawn["time"] == drawn["duration"]


def test_time_is_in_steps(page):
    assert page.find_element(By.ID, "clock").text.endswith(" steps")
    press(page, "\ue014")  # right arrow
    assert state(page)["time"] == 1


def test_violations_are_listed_and_lead_to_their_time(page):
    facts = page.find_element(By.ID, "facts").text
    if page.plan == "grid":
        assert "Certified" in facts and not page.find_element(By.ID, "events-card").is_displayed()
        return
    assert "1 violation" in facts and state(page)["conflicts"] == []
    item = page.find_element(By.CSS_SELECTOR, "#events button")
    assert "Collision: agents 1 and 2 overlap" in item.text
    item.click()
    assert 5 < state(page)["time"] < 6 and state(page)["conflicts"] == [1, 2]
    script = """
        const canvas = document.getElementById("scene");
        const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
        let red = 0;
        for (let i = 0; i < data.length; i += 4) red += data[i] === 0xd4 && data[i + 1] === 0x11 && data[i + 2] === 0x1c;
        return red;
    """
    page.execute_cdp_cmd(
        "Emulation.setEmulatedMedia", {"features": [{"name": "prefers-color-scheme", "value": "light"}]}
    )
    wait_for(page, lambda _: page.execute_script(script) > 500)  # two bodies of some 40 × 60 pixels


@pytest.mark.parametrize("width", [400, 700, 1400])
def test_page_never_scrolls_sideways(page, width):
    page.execute_cdp_cmd(
        "Emulation.setDeviceMetricsOverride", {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": False}
    )
    try:
        assert page.execute_script("return document.documentElement.scrollWidth") <= width
    finally:
        page.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})


def test_picture_is_drawn(browser, pages):  # noqa: F811
    """An SVG that the browser understands, as wide as it says, with a polygon for every body."""
    for name in ("grid", "cars"):
        browser.get((pages / f"{name}.svg").as_uri())
        assert browser.execute_script("return document.documentElement.viewBox.baseVal.width") == 1000
        assert browser.execute_script("return document.querySelectorAll('.body').length") >= 4
