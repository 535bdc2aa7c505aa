"""Parameters on the page: turned, refused, searched, kept in files."""

import json
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Page, expect

from .browsing import Daemon, is_patch, needs_chromium, theta_box

pytestmark = needs_chromium


def theta_slider(page: Page) -> Any:
    return page.get_by_role("slider", name="comparator.theta_on")


def theta_error(page: Page) -> Any:
    return page.locator("[id='p-comparator.theta_on-error']")


def test_a_slider_turns_a_parameter_and_the_reset_button_turns_it_back(page: Page, daemon: Daemon) -> None:
    reset = page.get_by_role("button", name="set comparator.theta_on back to the camera's value, 1")
    expect(reset).to_be_hidden()
    with page.expect_response(is_patch) as answer:
        theta_slider(page).fill("230")  # a little right of the middle, where steps are fine
    assert answer.value.ok
    expect(theta_box(page)).to_have_value("1.2")
    assert daemon.theta_on() == 1.2
    version = daemon.get("status")["parameters_version"]
    expect(page.locator("#version")).to_have_text(str(version))
    reset.click()
    expect(theta_box(page)).to_have_value("1")
    expect(reset).to_be_hidden()
    assert daemon.theta_on() == 1


@pytest.mark.parametrize("given", ["1000", "-1", "much", "Infinity"])
def test_an_invalid_value_is_explained_and_changes_nothing(page: Page, daemon: Daemon, given: str) -> None:
    before = daemon.get("parameters")
    theta_box(page).press("Control+a")
    theta_box(page).press_sequentially(given)
    theta_box(page).press("Enter")
    refused = daemon.patch({"comparator": {"theta_on": json.loads(given) if given[-1].isdigit() else given}})
    expect(theta_error(page)).to_have_text(f"Not applied. {refused.json()['detail']}")
    expect(theta_box(page)).to_have_value("1")
    assert daemon.get("parameters") == before
    theta_box(page).fill("1.5")
    with page.expect_response(is_patch):
        theta_box(page).press("Enter")
    expect(theta_error(page)).to_be_empty()
    daemon.patch({"comparator": {"theta_on": 1}})


def test_a_choice_is_a_parameter_too(page: Page, daemon: Daemon) -> None:
    with page.expect_response(is_patch):
        page.locator("[id='p-contrast_response.response']").select_option("linearised")
    expect(page.locator("#version")).to_have_text(str(daemon.get("status")["parameters_version"]))
    assert daemon.get("parameters")["parameters"]["contrast_response"]["response"] == "linearised"
    daemon.patch({"contrast_response": {"response": "logarithmic"}})
    expect(page.locator("[id='p-contrast_response.response']")).to_have_value("logarithmic")


def test_a_change_made_elsewhere_appears(page: Page, daemon: Daemon) -> None:
    daemon.patch({"temperature_c": 61.5})
    expect(page.locator("[id='p-temperature_c']")).to_have_value("61.5")
    daemon.patch({"temperature_c": 25})


def test_every_parameter_of_the_schema_has_a_field(page: Page, daemon: Daemon) -> None:
    for folded in page.locator(".group:not([open]) > summary").all()[::-1]:
        folded.click()
    for effect, values in daemon.get("parameters")["parameters"].items():
        names = [f"{effect}.{name}" for name in values] if isinstance(values, dict) else [effect]
        for name in names:
            expect(page.locator(f"[id='p-{name}']")).to_be_visible()


def test_an_effect_is_switched_off_and_on_again(page: Page, daemon: Daemon) -> None:
    switch = page.get_by_role("switch", name="threshold_mismatch on")
    expect(switch).to_be_checked()
    before = daemon.get("parameters")["parameters"]["threshold_mismatch"]
    with page.expect_response(is_patch):
        switch.click()
    expect(switch).not_to_be_checked()
    assert daemon.get("parameters")["parameters"]["threshold_mismatch"] == {"sigma": 0}
    with page.expect_response(is_patch):
        switch.click()
    assert daemon.get("parameters")["parameters"]["threshold_mismatch"] == before
    flicker = page.get_by_role("switch", name="flicker on")  # of the light; no camera has it on
    expect(flicker).to_be_disabled()


def test_parameters_are_searched(page: Page) -> None:
    page.keyboard.press("/")
    page.keyboard.type("latency jitter")
    expect(page.locator("[id='p-latency.jitter_us']")).to_be_visible()
    expect(theta_box(page)).to_be_hidden()
    page.locator("#search").fill("")
    expect(theta_box(page)).to_be_visible()


def test_presets_and_files(page: Page, daemon: Daemon, tmp_path: Path) -> None:
    before = daemon.get("parameters")["parameters"]
    with page.expect_download() as saving:
        page.locator("#save").click()
    saving.value.save_as(tmp_path / "mine.yaml")
    with page.expect_response(is_patch):
        page.locator("#preset").select_option("noisy")
    assert daemon.get("parameters")["parameters"] == daemon.get("presets")["noisy"]
    with page.expect_response("**/parameters/file"):
        page.locator("#load").set_input_files(tmp_path / "mine.yaml")
    assert daemon.get("parameters")["parameters"] == before
    (tmp_path / "bad.yaml").write_text("shutter: 1")
    page.locator("#load").set_input_files(tmp_path / "bad.yaml")
    expect(page.locator("#preset-error")).to_contain_text("no such key")
