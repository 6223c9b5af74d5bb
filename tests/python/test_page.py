"""The replay page in a real browser: it opens from disk, plays, seeks, and draws what was recorded.

Needs `chromium` and `chromedriver` (Debian: `chromium`, `chromium-driver`) and `selenium`; skipped without them.
"""

import json
import math
import shutil
import time
from pathlib import Path

import pytest

selenium = pytest.importorskip("selenium")
from selenium import webdriver  # noqa: E402
from selenium.webdriver.chrome.service import Service  # noqa: E402
from selenium.webdriver.common.action_chains import ActionChains  # noqa: E402
from selenium.webdriver.common.by import By  # noqa: E402
from selenium.webdriver.common.keys import Keys  # noqa: E402

CHROMIUM = shutil.which("chromium")
DRIVER = shutil.which("chromedriver")
pytestmark = pytest.mark.skipif(not (CHROMIUM and DRIVER), reason="no chromium or no chromedriver")

# poses are stored in steps of 0.1 mm and 0.1 mrad, so they are off by at most half of that
POSE_TOLERANCE = 1e-4


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    """Headless Chromium that records its console and every request."""
    options = webdriver.ChromeOptions()
    options.binary_location = CHROMIUM
    for flag in (
        "--headless=new",
        "--no-sandbox",
        "--disable-gpu",
        "--no-first-run",
        "--disable-background-networking",
        "--disable-component-update",
        "--disable-sync",
        f"--user-data-dir={tmp_path_factory.mktemp('chromium')}",
        "--window-size=1400,1000",
    ):
        options.add_argument(flag)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    driver = webdriver.Chrome(options=options, service=Service(DRIVER))
    yield driver
    driver.quit()


@pytest.fixture
def page(browser, mission_page):
    """The page, freshly opened from disk; checks at the end that it fetched nothing and complained about nothing."""
    browser.get("about:blank")
    for log in ("browser", "performance"):
        browser.get_log(log)
    browser.get(mission_page.as_uri())
    yield browser
    messages = [json.loads(entry["message"])["message"] for entry in browser.get_log("performance")]
    requests = [m["params"]["request"]["url"] for m in messages if m["method"] == "Network.requestWillBeSent"]
    # chrome:// are the browser's own pages
    assert [url for url in requests if not url.startswith(("data:", "chrome://"))] == [mission_page.as_uri()]
    assert browser.get_log("browser") == []


def state(page):
    return page.execute_script("return window.cohaul.state()")


def press(page, *keys):
    ActionChains(page).send_keys(*keys).perform()


def wait_for(page, condition, seconds=10.0):
    end = time.monotonic() + seconds
    while not condition(state(page)):
        assert time.monotonic() < end, state(page)
        time.sleep(0.02)
    return state(page)


def set_slider(page, value):
    script = """
        const slider = document.getElementById("slider");
        slider.value = arguments[0];
        slider.dispatchEvent(new Event("input", { bubbles: true }));
    """
    page.execute_script(script, value)


def assert_pose(drawn, expected):
    x, y, yaw = expected
    assert abs(drawn["x"] - x) < POSE_TOLERANCE
    assert abs(drawn["y"] - y) < POSE_TOLERANCE
    assert abs(math.remainder(drawn["yaw"] - yaw, math.tau)) < POSE_TOLERANCE


def test_page_opens_at_rest_with_every_body(page):
    drawn = state(page)
    assert drawn["time"] == drawn["startTime"] and not drawn["playing"]
    assert drawn["loads"] and drawn["robots"] and drawn["duration"] > 0
    assert all(math.isfinite(body[key]) for body in drawn["loads"] + drawn["robots"] for key in ("x", "y", "yaw"))


def test_canvas_is_painted(page):
    script = """
        const canvas = document.getElementById("scene");
        const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
        return new Set(new Uint32Array(data.buffer)).size;
    """
    assert page.execute_script(script) > 50  # anti-aliased shapes in several colours; a blank canvas has 1


def test_play_button_plays_and_pauses(page):
    button = page.find_element(By.ID, "play")
    button.click()
    playing = wait_for(page, lambda s: s["time"] > s["startTime"] + 0.5)
    assert playing["playing"] and button.get_attribute("aria-label") == "Pause"
    button.click()
    paused = state(page)
    time.sleep(0.2)
    assert not paused["playing"] and state(page)["time"] == paused["time"]


def test_slider_seeks_and_the_end_is_the_recorded_final_pose(page, mission_final_pose):
    end = state(page)["startTime"] + state(page)["duration"]
    set_slider(page, end / 2)
    assert abs(state(page)["time"] - end / 2) < 1e-6
    assert not math.isclose(state(page)["loads"][0]["x"], mission_final_pose[0], abs_tol=POSE_TOLERANCE)
    set_slider(page, end)
    assert state(page)["time"] == end
    assert_pose(state(page)["loads"][0], mission_final_pose)


def test_slider_can_be_dragged(page):
    slider = page.find_element(By.ID, "slider")
    width = slider.size["width"]
    ActionChains(page).move_to_element_with_offset(slider, -width // 2 + 8, 0).click_and_hold().move_by_offset(
        width // 2 - 8, 0
    ).release().perform()
    share = (state(page)["time"] - state(page)["startTime"]) / state(page)["duration"]
    assert 0.4 < share < 0.6  # the thumb is some pixels wide


def test_playing_to_the_end_stops_at_the_final_pose(page, mission_final_pose):
    page.execute_script("cohaul.seek(cohaul.state().duration + cohaul.state().startTime - 1); cohaul.play()")
    drawn = wait_for(page, lambda s: not s["playing"])
    assert drawn["time"] == drawn["startTime"] + drawn["duration"]
    assert_pose(drawn["loads"][0], mission_final_pose)


def test_keys(page, mission_final_pose):
    start = state(page)["startTime"]
    press(page, Keys.END)
    assert_pose(state(page)["loads"][0], mission_final_pose)
    press(page, Keys.HOME)
    assert state(page)["time"] == start
    press(page, Keys.ARROW_RIGHT)
    assert abs(state(page)["time"] - start - 1) < 1e-9
    ActionChains(page).key_down(Keys.SHIFT).send_keys(Keys.ARROW_RIGHT).key_up(Keys.SHIFT).perform()
    assert abs(state(page)["time"] - start - min(11, state(page)["duration"])) < 1e-9
    press(page, Keys.ARROW_LEFT)
    before = state(page)["speed"]
    press(page, "]")
    assert state(page)["speed"] > before
    press(page, "[")
    assert state(page)["speed"] == before
    press(page, Keys.SPACE)
    wait_for(page, lambda s: s["playing"])
    press(page, Keys.SPACE)
    assert not state(page)["playing"]
    press(page, "?")
    assert page.find_element(By.ID, "help").is_displayed()
    press(page, "?")
    assert not page.find_element(By.ID, "help").is_displayed()


def test_keys_work_with_a_focused_slider(page):
    page.find_element(By.ID, "slider").click()
    before = state(page)["time"]
    press(page, Keys.ARROW_LEFT)
    assert abs(state(page)["time"] - before + 1) < 1e-6


def test_click_into_a_plot_seeks(page):
    ActionChains(page).move_to_element(page.find_element(By.ID, "chart")).click().perform()
    share = (state(page)["time"] - state(page)["startTime"]) / state(page)["duration"]
    assert 0.4 < share < 0.6  # the axis starts right of the labels


def test_robot_under_the_pointer_explains_itself(page):
    scene = page.find_element(By.ID, "scene")
    width, height = scene.size["width"], scene.size["height"]
    tip = page.find_element(By.ID, "tip")
    found = set()
    for px in range(-width // 2 + 4, width // 2 - 4, 24):
        for py in (-height // 4, 0, height // 4):
            page.execute_script(
                "document.getElementById('scene').dispatchEvent(new PointerEvent('pointermove',"
                " {clientX: arguments[0], clientY: arguments[1]}))",
                scene.rect["x"] + width / 2 + px,
                scene.rect["y"] + height / 2 + py,
            )
            if tip.is_displayed():
                found.add(tip.text.splitlines()[0])
    assert found


def test_wheel_zooms_and_f_fits(page):
    def pixels():
        return page.execute_script("return document.getElementById('scene').toDataURL()")

    fitted = pixels()
    scene = page.find_element(By.ID, "scene")
    page.execute_script(
        "arguments[0].dispatchEvent(new WheelEvent('wheel', {deltaY: -400, clientX: 300, clientY: 300, cancelable: true}))",
        scene,
    )
    assert pixels() != fitted
    press(page, "f")
    assert pixels() == fitted


@pytest.mark.parametrize("width", [400, 700, 1400])
def test_page_never_scrolls_sideways(page, width):
    page.execute_cdp_cmd(
        "Emulation.setDeviceMetricsOverride", {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": False}
    )
    try:
        assert page.execute_script("return document.documentElement.scrollWidth") <= width
    finally:
        page.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})


def test_page_plays_inside_a_notebook_frame(page, mission_page):
    """Notebooks show the page as `srcdoc` of an iframe."""
    page.execute_script(
        "const frame = document.createElement('iframe'); frame.srcdoc = arguments[0]; frame.id = 'cell';"
        "frame.style.cssText = 'width: 700px; height: 500px'; document.body.append(frame)",
        mission_page.read_text(encoding="utf-8"),
    )
    ready = "return document.getElementById('cell').contentWindow.cohaul?.state().robots.length ?? 0"
    end = time.monotonic() + 10
    while not page.execute_script(ready):
        assert time.monotonic() < end
        time.sleep(0.05)
