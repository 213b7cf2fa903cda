//! One JSON request over HTTP to a program on this machine.

use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::{SocketAddr, TcpStream};
use std::time::Duration;

use anyhow::{Context, Result, ensure};
use serde_json::Value;

/// Longest answer, bytes: a picture as text.
const LONGEST: u64 = 64 << 20;

/// Sends a request and returns what came back.
///
/// # Errors
/// When nothing listens, or the answer is no HTTP, no JSON, or longer than 64 MiB.
pub fn request(address: SocketAddr, method: &str, path: &str, body: Option<&Value>) -> Result<Value> {
    let mut stream = TcpStream::connect(address).with_context(|| format!("connect to {address}"))?;
    stream.set_read_timeout(Some(Duration::from_secs(120)))?;
    let body = body.map(Value::to_string).unwrap_or_default();
    let length = body.len();
    let head = format!(
        "{method} {path} HTTP/1.1\r\nHost: {address}\r\nContent-Type: application/json\r\nContent-Length: {length}\r\nConnection: close\r\n\r\n"
    );
    stream.write_all(head.as_bytes())?;
    stream.write_all(body.as_bytes())?;
    let mut reader = BufReader::new(stream.take(LONGEST));
    let mut line = String::new();
    reader.read_line(&mut line)?;
    ensure!(line.starts_with("HTTP/1.1 "), "expected an answer of HTTP/1.1, found {line:?}");
    let mut expected = None;
    loop {
        line.clear();
        ensure!(reader.read_line(&mut line)? > 0, "expected an end of the head, found none");
        if line.trim().is_empty() {
            break;
        }
        if let Some(length) = line.to_ascii_lowercase().strip_prefix("content-length:") {
            expected = Some(length.trim().parse::<u64>().context("a length")?);
        }
    }
    let mut body = Vec::new();
    reader.take(expected.unwrap_or(LONGEST)).read_to_end(&mut body)?;
    serde_json::from_slice(&body).context("expected JSON")
}
