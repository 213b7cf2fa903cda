//! JSON over HTTP with a program on this machine.

use std::net::SocketAddr;
use std::time::Duration;

use anyhow::{Context, Result};
use serde_json::Value;
use ureq::http::Request;

/// Longest answer, bytes: a picture as text.
const LONGEST: u64 = 64 << 20;

/// What talks to one address, without a proxy.
pub struct Client {
    agent: ureq::Agent,
    address: SocketAddr,
}

impl Client {
    pub fn new(address: SocketAddr) -> Self {
        let agent = ureq::Agent::config_builder()
            .proxy(None)
            .http_status_as_error(false)
            .timeout_global(Some(Duration::from_secs(120)))
            .build()
            .new_agent();
        Self { agent, address }
    }

    /// Sends a request and returns what came back.
    ///
    /// # Errors
    /// When nothing listens, or the answer is no HTTP, no JSON, or longer than 64 MiB.
    pub fn request(&self, method: &str, path: &str, body: Option<&Value>) -> Result<Value> {
        let Self { agent, address } = self;
        let head = Request::builder().method(method).uri(format!("http://{address}{path}"));
        let answer = match body {
            Some(body) => agent.run(head.header("Content-Type", "application/json").body(body.to_string())?),
            None => agent.run(head.body(())?),
        };
        let mut answer = answer.with_context(|| format!("{method} http://{address}{path}"))?;
        let text = answer.body_mut().with_config().limit(LONGEST).read_to_string().context("an answer")?;
        serde_json::from_str(&text).context("expected JSON")
    }
}
