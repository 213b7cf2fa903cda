//! Headless Chromium through the WebDriver protocol.

use std::net::{Ipv4Addr, TcpListener};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail, ensure};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};

use super::graphics::Graphics;
use super::http::Client;
use crate::workspace::answers;

/// What makes Chromium leave the network alone.
const FLAGS: [&str; 9] = [
    "--headless",
    "--no-sandbox",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--enable-precise-memory-info",
    "--window-size=1280,720",
];

/// A browser with one page; ends when it is dropped.
pub struct Browser {
    driver: Child,
    client: Client,
    session: String,
    profile: PathBuf,
}

impl Browser {
    /// Starts it with an empty profile.
    ///
    /// # Errors
    /// When chromedriver or Chromium is missing or does not start.
    pub fn start(graphics: Graphics) -> Result<Self> {
        for (program, package) in [("chromedriver", "chromium-driver"), ("chromium", "chromium")] {
            ensure!(
                answers(Command::new(program).arg("--version")),
                "expected {program}, found none; Debian's package {package} has it"
            );
        }
        let port = TcpListener::bind((Ipv4Addr::LOCALHOST, 0))
            .and_then(|free| free.local_addr())
            .context("a port")?;
        let driver = Command::new("chromedriver")
            .arg(format!("--port={}", port.port()))
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .context("start chromedriver")?;
        let profile =
            std::env::temp_dir().join(format!("policy-space-browser-{}-{}", std::process::id(), port.port()));
        let mut browser = Self { driver, client: Client::new(port), session: String::new(), profile };
        let start = Instant::now();
        while browser.client.request("GET", "/status", None).is_err() {
            ensure!(start.elapsed() < Duration::from_secs(30), "chromedriver does not answer");
            thread::sleep(Duration::from_millis(100));
        }
        let arguments: Vec<String> = FLAGS
            .iter()
            .chain(graphics.flags())
            .map(ToString::to_string)
            .chain([format!("--user-data-dir={}", browser.profile.display())])
            .collect();
        let wanted = json!({"capabilities": {"alwaysMatch": {
            "goog:chromeOptions": {"args": arguments},
            "goog:loggingPrefs": {"browser": "ALL"},
        }}});
        let session = value(browser.client.request("POST", "/session", Some(&wanted))?)?;
        browser.session = session["sessionId"].as_str().context("expected a session, found none")?.to_owned();
        Ok(browser)
    }

    fn post(&self, verb: &str, body: &Value) -> Result<Value> {
        value(self.client.request("POST", &format!("/session/{}/{verb}", self.session), Some(body))?)
    }

    /// Opens a page.
    ///
    /// # Errors
    /// When the browser can't.
    pub fn open(&self, url: &str) -> Result<()> {
        self.post("url", &json!({"url": url})).map(|_| ())
    }

    /// Runs a script, such as `return document.title`.
    ///
    /// # Errors
    /// When it throws.
    pub fn run(&self, script: &str) -> Result<Value> {
        self.post("execute/sync", &json!({"script": script, "args": []}))
    }

    /// Presses or releases keys, such as `w` or U+E008 for Shift.
    ///
    /// # Errors
    /// When the browser can't.
    pub fn keys(&self, down: bool, keys: &[&str]) -> Result<()> {
        let kind = if down { "keyDown" } else { "keyUp" };
        let actions: Vec<Value> = keys.iter().map(|key| json!({"type": kind, "value": key})).collect();
        self.post("actions", &json!({"actions": [{"type": "key", "id": "keyboard", "actions": actions}]}))
            .map(|_| ())
    }

    /// Runs a command of the developer tools' protocol.
    ///
    /// # Errors
    /// When the browser refuses it.
    pub fn devtools(&self, command: &str, parameters: &Value) -> Result<Value> {
        self.post("goog/cdp/execute", &json!({"cmd": command, "params": parameters}))
    }

    /// Clicks on the middle of an element, as a person does.
    ///
    /// # Errors
    /// When there is no such element or something covers it.
    pub fn click(&self, element: &str) -> Result<()> {
        let found = self.post("element", &json!({"using": "css selector", "value": element}))?;
        let id = found.as_object().and_then(|found| found.values().next()).and_then(Value::as_str);
        let id = id.with_context(|| format!("expected an element {element}, found none"))?;
        self.post(&format!("element/{id}/click"), &json!({})).map(|_| ())
    }

    /// Gives the window another size.
    ///
    /// # Errors
    /// When the browser can't.
    pub fn resize(&self, width: u32, height: u32) -> Result<()> {
        self.post("window/rect", &json!({"width": width, "height": height})).map(|_| ())
    }

    /// The tab that is spoken to.
    ///
    /// # Errors
    /// When it is gone.
    pub fn window(&self) -> Result<String> {
        let found = value(self.client.request("GET", &format!("/session/{}/window", self.session), None)?)?;
        found.as_str().map(str::to_owned).context("expected a window, found none")
    }

    /// Opens another tab, empty.
    ///
    /// # Errors
    /// When the browser can't.
    pub fn new_tab(&self) -> Result<String> {
        let made = self.post("window/new", &json!({"type": "tab"}))?;
        made["handle"].as_str().map(str::to_owned).context("expected a window, found none")
    }

    /// Speaks to that tab from now on.
    ///
    /// # Errors
    /// When it is gone.
    pub fn switch_to(&self, window: &str) -> Result<()> {
        self.post("window", &json!({"handle": window})).map(|_| ())
    }

    /// A picture of the page as it is composed, as PNG.
    ///
    /// # Errors
    /// When the browser gives none, or the file can't be written.
    pub fn picture(&self, path: &Path) -> Result<()> {
        let text =
            value(self.client.request("GET", &format!("/session/{}/screenshot", self.session), None)?)?;
        write_picture(path, text.as_str())
    }

    /// The picture on the page's canvas, as PNG. Returns the number of its colours: of one colour nothing is to be seen.
    ///
    /// # Errors
    /// When the page gives none, or the file can't be written.
    pub fn canvas(&self, path: &Path) -> Result<u64> {
        let picture = self.run("return window.policySpacePicture()")?;
        write_picture(path, picture["png"].as_str())?;
        picture["colours"].as_u64().context("expected a number of colours, found none")
    }

    /// What the page has complained of since the last call.
    ///
    /// # Errors
    /// When the browser keeps no log.
    pub fn complaints(&self) -> Result<Vec<String>> {
        let log = self.post("se/log", &json!({"type": "browser"}))?;
        let severe = log.as_array().into_iter().flatten().filter(|entry| entry["level"] == "SEVERE");
        Ok(severe.filter_map(|entry| entry["message"].as_str().map(str::to_owned)).collect())
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        if !self.session.is_empty() {
            let _ = self.client.request("DELETE", &format!("/session/{}", self.session), None);
        }
        let _ = self.driver.kill();
        let _ = self.driver.wait();
        let _ = std::fs::remove_dir_all(&self.profile);
    }
}

/// The value of an answer, or the error in it.
fn value(mut answer: Value) -> Result<Value> {
    if let Some(error) = answer["value"]["error"].as_str() {
        bail!("the browser says {error}: {}", answer["value"]["message"].as_str().unwrap_or_default());
    }
    Ok(answer["value"].take())
}

fn write_picture(path: &Path, base64: Option<&str>) -> Result<()> {
    let text = base64.context("expected a picture, found none")?;
    let png = STANDARD.decode(text).context("expected a picture as base64")?;
    std::fs::write(path, png).with_context(|| format!("write {}", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_of_the_browser_is_one() {
        let said = value(json!({"value": {"error": "no such window", "message": "gone"}})).unwrap_err();
        assert!(said.to_string().contains("no such window: gone"));
        assert_eq!(value(json!({"value": 3})).unwrap(), json!(3));
    }
}
