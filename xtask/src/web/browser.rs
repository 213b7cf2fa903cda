//! Headless Chromium through the WebDriver protocol.

use std::net::{Ipv4Addr, SocketAddr, TcpListener};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail, ensure};
use serde_json::{Value, json};

use super::http::request;
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

/// What a page can draw with. The processor does it in both cases.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Graphics {
    /// WebGPU.
    WebGpu,
    /// WebGL2 alone, as in browsers without WebGPU.
    WebGl2,
}

impl Graphics {
    const fn flags(self) -> &'static [&'static str] {
        match self {
            // Without Vulkan in all of Chromium the canvas stays empty.
            Graphics::WebGpu => &[
                "--enable-unsafe-webgpu",
                "--use-webgpu-adapter=swiftshader",
                "--enable-unsafe-swiftshader",
                "--enable-features=Vulkan",
                "--use-vulkan=swiftshader",
                "--use-angle=vulkan",
            ],
            Graphics::WebGl2 => {
                &["--disable-features=WebGPU", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
            }
        }
    }
}

/// A browser with one page; ends when it is dropped.
pub struct Browser {
    driver: Child,
    address: SocketAddr,
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
        let mut browser = Self { driver, address: port, session: String::new(), profile };
        let start = Instant::now();
        while request(port, "GET", "/status", None).is_err() {
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
        let session = value(request(port, "POST", "/session", Some(&wanted))?)?;
        browser.session = session["sessionId"].as_str().context("expected a session, found none")?.to_owned();
        Ok(browser)
    }

    fn post(&self, verb: &str, body: &Value) -> Result<Value> {
        value(request(self.address, "POST", &format!("/session/{}/{verb}", self.session), Some(body))?)
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

    /// A picture of the page as it is composed, as PNG.
    ///
    /// # Errors
    /// When the browser gives none, or the file can't be written.
    pub fn picture(&self, path: &Path) -> Result<()> {
        let text =
            value(request(self.address, "GET", &format!("/session/{}/screenshot", self.session), None)?)?;
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
            let _ = request(self.address, "DELETE", &format!("/session/{}", self.session), None);
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
    let png = from_base64(base64.context("expected a picture, found none")?)?;
    std::fs::write(path, png).with_context(|| format!("write {}", path.display()))
}

fn from_base64(text: &str) -> Result<Vec<u8>> {
    let mut out = Vec::with_capacity(text.len() / 4 * 3);
    let (mut bits, mut held) = (0u32, 0);
    for byte in text.bytes().filter(|byte| *byte != b'=') {
        let value = match byte {
            b'A'..=b'Z' => byte - b'A',
            b'a'..=b'z' => byte - b'a' + 26,
            b'0'..=b'9' => byte - b'0' + 52,
            b'+' => 62,
            b'/' => 63,
            _ => bail!("expected base64, found {:?}", char::from(byte)),
        };
        bits = (bits << 6 | u32::from(value)) & 0x3fff;
        held += 6;
        if held >= 8 {
            held -= 8;
            out.push((bits >> held) as u8);
        }
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_comes_back_from_text() {
        assert_eq!(from_base64("aGVsbG8gd29ybGQ=").unwrap(), b"hello world");
        assert!(from_base64("a*").is_err());
    }

    #[test]
    fn an_error_of_the_browser_is_one() {
        let said = value(json!({"value": {"error": "no such window", "message": "gone"}})).unwrap_err();
        assert!(said.to_string().contains("no such window: gone"));
        assert_eq!(value(json!({"value": 3})).unwrap(), json!(3));
    }
}
