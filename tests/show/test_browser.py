"""Reports in a real browser; skipped where Debian's chromium and its driver are missing."""

import re
import shutil
from dataclasses import replace
from pathlib import Path

import made_up_result as made
import numpy as np
import pytest
from selenium.webdriver import ActionChains, Chrome, ChromeOptions
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.wait import WebDriverWait

import presswear as pw
from presswear.show.report import write_report

BROWSER = shutil.which("chromium")
DRIVER = shutil.which("chromedriver")
MAX_BYTES = 2e6
MAX_HEIGHT = 6000

pytestmark = pytest.mark.skipif(
    not (BROWSER and DRIVER), reason="no chromium with its driver"
)


@pytest.fixture(scope="module")
def browser():
    options = ChromeOptions()
    options.binary_location = str(BROWSER)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    for flag in (
        "--headless=new",
        "--no-sandbox",
        "--disable-gpu",
        "--disable-dev-shm-usage",
    ):
        options.add_argument(flag)
    driver = Chrome(options=options, service=Service(DRIVER))
    yield driver
    driver.quit()


@pytest.fixture(scope="module")
def report(tmp_path_factory):
    folder = tmp_path_factory.mktemp("report")
    return write_report(replace(made.made_up(made.BOTH, 2), path=folder))


def show(browser: Chrome, report: Path, width: int) -> None:
    size = {"width": width, "height": 800, "deviceScaleFactor": 1, "mobile": False}
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
    browser.execute("getLog", {"type": "browser"})  # of other pages
    browser.get(report.as_uri())
    WebDriverWait(browser, 60.0).until(is_loaded)


def is_as_wide_as_its_window(browser: Chrome) -> bool:
    page = "document.documentElement"
    script = f"return {page}.scrollWidth === {page}.clientWidth"
    return bool(browser.execute_script(script))


def open_all_parts(browser: Chrome) -> None:
    parts = "document.querySelectorAll('details')"
    browser.execute_script(f"{parts}.forEach(part => part.open = true)")


def is_loaded(browser: Chrome) -> bool:
    return bool(browser.execute_script("return document.readyState === 'complete'"))


@pytest.fixture(scope="module")
def blanking(tmp_path_factory):
    result = made.made_up(pw.scenes.press_blanking(), 2)
    folder = tmp_path_factory.mktemp("blanking")
    return write_report(replace(result, path=folder), has_all_figures=False)


@pytest.mark.parametrize("name", ["report", "blanking"])
def test_the_first_screen_has_drawing_and_key_numbers(browser, name, request):
    show(browser, request.getfixturevalue(name), 1280)
    numbers = browser.find_elements(By.CSS_SELECTOR, ".key > div")
    assert 6 <= len(numbers) <= 14
    drawing = browser.find_element(By.CSS_SELECTOR, ".drawing svg")
    for part in (drawing, *numbers):
        assert part.rect["y"] + part.rect["height"] <= 800
    assert drawing.rect["width"] > 100
    assert browser.execute_script("return document.body.scrollHeight") < MAX_HEIGHT
    errors = browser.execute("getLog", {"type": "browser"})["value"]
    assert errors == []


def test_a_report_executes_no_script(browser, report, tmp_path):
    planted = "<script>document.title = 'executed'</script>"
    planted += '<img src=x onerror="document.title = 2">'
    file = tmp_path / "planted.html"
    file.write_text(report.read_text().replace("</header>", f"</header>{planted}"))
    show(browser, file, 1280)
    assert browser.title not in ("executed", "2")
    # Its own pictures and styles are shown.
    assert browser.find_element(By.CSS_SELECTOR, ".drawing svg").size["width"] > 100


@pytest.mark.slow
def test_a_report_of_seven_joints_is_small(tmp_path):
    scene = replace(made.BODY, joints="O2,O7,A,B,C,D,E")
    seven = write_report(replace(made.made_up(scene, 2), path=tmp_path))
    assert seven.stat().st_size < MAX_BYTES


def test_a_narrow_page_does_not_scroll_sideways(browser, report):
    show(browser, report, 400)
    open_all_parts(browser)
    assert is_as_wide_as_its_window(browser)
    value = browser.find_element(By.CSS_SELECTOR, ".key .value")
    assert value.rect["y"] < 800
    # The heading says after how many strokes the limits are compared.
    heading, *columns = browser.find_elements(By.CSS_SELECTOR, ".limits thead th")
    assert heading.is_displayed()
    assert not any(column.is_displayed() for column in columns)
    # A verdict on a limit is in one line.
    lines = "[...document.querySelectorAll('.light')].map(box => box.getClientRects().length)"
    assert {*browser.execute_script(f"return {lines}")} == {1}


def test_a_figure_is_enlarged_and_moved_by_mouse_and_keyboard(browser, report):
    show(browser, report, 400)
    box = browser.find_element(By.CSS_SELECTOR, "figure .zoom")
    svg = box.find_element(By.TAG_NAME, "svg")

    def view() -> list[float]:
        return [float(text) for text in str(svg.get_dom_attribute("viewBox")).split()]

    whole = view()
    enlarge, reduce_, everything = box.find_elements(By.TAG_NAME, "button")
    enlarge.click()
    half = view()
    assert half[2:] == [0.5 * size for size in whole[2:]]
    assert half[:2] == [0.25 * size for size in whole[2:]]  # about the middle
    reduce_.click()
    assert view() == whole
    svg.send_keys("+", "+", Keys.ARROW_RIGHT)
    moved = view()
    assert moved[2] == 0.25 * whole[2]
    assert moved[0] == pytest.approx((0.375 + 0.05) * whole[2])
    hand = ActionChains(browser).move_to_element(svg)
    hand.click_and_hold().move_by_offset(20, 0).release().perform()
    assert view()[0] < moved[0]
    everything.click()
    ActionChains(browser).double_click(svg).perform()
    assert view()[2] == 0.5 * whole[2]
    svg.send_keys("0")
    assert view() == whole
    assert browser.execute("getLog", {"type": "browser"})["value"] == []


@pytest.fixture(scope="module")
def running(tmp_path_factory):
    """Return the report of a run, whose film moves the mechanism."""
    folder = tmp_path_factory.mktemp("running") / "result"
    groove = pw.linkage.Surface(1e-5 * (1.0 + np.cos(np.linspace(0.0, 6.28, 360))))
    scene = pw.scenes.press_blanking(
        engine="dae", cycles=4, wear_updates=0, surfaces={"C": (groove, None)}
    )
    return write_report(pw.run(scene, folder))


@pytest.mark.parametrize("width", [400, 1280])
def test_a_slider_moves_the_mechanism(browser, running, width):
    show(browser, running, width)
    slider = browser.find_element(By.CSS_SELECTOR, ".motion input")
    body = browser.find_element(By.CSS_SELECTOR, ".motion .body")
    text = browser.find_element(By.CSS_SELECTOR, ".motion output")
    places = [body.get_dom_attribute("transform")]
    assert re.fullmatch(r"crank angle \d+ degrees, A \d+ N, C \d+ N", text.text)
    slider.send_keys(Keys.ARROW_RIGHT)
    places.append(body.get_dom_attribute("transform"))
    slider.click()  # in the middle
    places.append(body.get_dom_attribute("transform"))
    slider.send_keys(Keys.END)
    places.append(body.get_dom_attribute("transform"))
    assert len({*places}) == 4
    # The worn bearing turns as its body does.
    worn = browser.find_element(By.CSS_SELECTOR, ".motion .outline")
    number = int(worn.get_dom_attribute("data-body") or 0)
    bodies = browser.find_elements(By.CSS_SELECTOR, ".motion .body")
    pose = bodies[number].get_dom_attribute("transform") or ""
    assert pose.endswith(f" {worn.get_dom_attribute('transform')}")
    assert browser.execute("getLog", {"type": "browser"})["value"] == []
    assert is_as_wide_as_its_window(browser)


def test_parts_open_by_mouse_keyboard_and_contents(browser, report):
    show(browser, report, 1280)
    closed = browser.find_elements(By.CSS_SELECTOR, "details:not([open])")
    assert len(closed) >= 4
    closed[0].find_element(By.TAG_NAME, "summary").click()
    closed[1].find_element(By.TAG_NAME, "summary").send_keys(Keys.ENTER)
    links = browser.find_elements(By.CSS_SELECTOR, "nav a")
    name = closed[2].find_element(By.TAG_NAME, "summary").text
    next(link for link in links if link.text == name).click()
    assert browser.find_elements(By.CSS_SELECTOR, "details:not([open])") == closed[3:]
