//! How the page treats a stranger: touch, pads, another size, full screen, a hidden tab, a browser that lacks something.

use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, ensure};
use serde_json::{Map, Value, json};

use super::browser::Browser;
use super::graphics::Graphics;

/// Longest that the page may take for any of these.
const PATIENCE: Duration = Duration::from_secs(60);

/// A pad with the stick ahead, the right trigger pulled and d-pad up pressed.
const PAD: &str = "navigator.getGamepads = () => [{ connected: true, mapping: 'standard', axes: [0, -1, 0, 0],
  buttons: Array.from({ length: 17 }, (_, i) => ({ pressed: i === 7 || i === 12, value: i === 7 ? 1 : 0 })) }];";

/// Tries each with a page that plays; returns what held by name. The browser is of no use for playing afterwards.
///
/// # Errors
/// When the browser can't do what is asked.
pub fn of_playing(browser: &Browser) -> Result<Map<String, Value>> {
    let mut held = Map::new();
    let mut add = |name: &str, holds: bool| held.insert(name.to_owned(), json!(holds));

    // Two thumbs: the left stick ahead, and the button to run.
    browser.devtools("Emulation.setTouchEmulationEnabled", &json!({"enabled": true, "maxTouchPoints": 5}))?;
    browser.run("window.dispatchEvent(new Event('touchstart'))")?;
    let points =
        json!([middle_of(browser, "#stick-left", 0.1)?, middle_of(browser, "[data-hold=run]", 0.5)?]);
    browser.devtools("Input.dispatchTouchEvent", &json!({"type": "touchStart", "touchPoints": points}))?;
    add("touch", comes(browser, "s => s.pad[1] > 0.7 && s.pad[5] === 1")?);
    browser.devtools("Input.dispatchTouchEvent", &json!({"type": "touchEnd", "touchPoints": []}))?;
    add("touch_ends", comes(browser, "s => s.pad[1] === 0 && s.pad[5] === 0")?);
    browser.devtools("Emulation.setTouchEmulationEnabled", &json!({"enabled": false}))?;

    browser.run(PAD)?;
    add("pad", comes(browser, "s => s.pad[1] === 1 && s.pad[5] === 1 && (s.bits & 64) !== 0")?);
    browser.run("navigator.getGamepads = () => []")?;

    browser.resize(800, 500)?;
    let fits = "() => { const c = document.getElementById('view');
      return innerWidth <= 800 && c.clientWidth === innerWidth && Math.abs(c.width / c.height - innerWidth / innerHeight) < 0.02; }";
    add("resizes", comes(browser, fits)?);
    browser.resize(1280, 720)?;

    browser.click("#full")?;
    add("full_screen", comes(browser, "() => document.fullscreenElement !== null")?);
    browser.click("#full")?;
    comes(browser, "() => document.fullscreenElement === null")?;

    browser.click("#pause")?;
    add("pauses", stands(browser)?);
    browser.click("#pause")?;
    add("continues", !stands(browser)?);

    // Another tab in front.
    let page = browser.window()?;
    let other = browser.new_tab()?;
    browser.switch_to(&other)?;
    browser.switch_to(&page)?;
    let hides = browser.run("return document.hidden")? == true;
    if !hides {
        // A headless browser may show all its tabs at once.
        browser.run("Object.defineProperty(document, 'hidden', { get: () => true, configurable: true })")?;
    }
    add("waits_when_hidden", stands(browser)?);
    browser.run("delete document.hidden; document.dispatchEvent(new Event('visibilitychange'))")?;
    add("goes_on_when_shown", hides || !stands(browser)?);
    Ok(held)
}

/// What the page says in a browser that lacks something; it must be that.
///
/// # Errors
/// When the browser can't be started.
pub fn without(page: &str) -> Result<Map<String, Value>> {
    let mut held = Map::new();
    let browser = Browser::start(Graphics::Nothing)?;
    for (name, says) in [("says_no_webgl2", "neither WebGPU nor WebGL2"), ("says_no_wasm", "no WebAssembly")]
    {
        browser.open(page)?;
        let shown =
            "() => !document.getElementById('problem').hidden && document.getElementById('loading').hidden";
        let shows = comes(&browser, shown)?;
        let text = browser.run("return document.getElementById('problem').textContent")?;
        let text = text.as_str().context("expected a text, found none")?;
        held.insert(name.to_owned(), json!(shows && text.contains(says)));
        let source = json!({"source": "delete globalThis.WebAssembly"});
        browser.devtools("Page.addScriptToEvaluateOnNewDocument", &source)?;
    }
    Ok(held)
}

/// True once a function of the page's state returns true.
fn comes(browser: &Browser, holds: &str) -> Result<bool> {
    let start = Instant::now();
    while start.elapsed() < PATIENCE {
        if browser.run(&format!("return ({holds})(window.policySpace ? window.policySpace() : {{}})"))?
            == true
        {
            return Ok(true);
        }
        thread::sleep(Duration::from_millis(100));
    }
    Ok(false)
}

/// True when no tick is run for a second.
fn stands(browser: &Browser) -> Result<bool> {
    let ticks = || browser.run("return window.policySpace().ticks");
    // What was under way when it was asked to stop.
    thread::sleep(Duration::from_millis(500));
    let before = ticks()?;
    thread::sleep(Duration::from_secs(2));
    Ok(before == ticks()?)
}

/// A touch on an element, so far down from its top.
fn middle_of(browser: &Browser, element: &str, down: f64) -> Result<Value> {
    let script = format!(
        "const b = document.querySelector('{element}').getBoundingClientRect();
         return [b.left + 0.5 * b.width, b.top + {down} * b.height];"
    );
    let found = browser.run(&script)?;
    ensure!(found[0].is_number(), "expected the place of {element}, found {found}");
    Ok(json!({"x": found[0], "y": found[1], "id": element.len()}))
}
