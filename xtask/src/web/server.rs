//! A static server for one folder, on this machine only: GET and HEAD, compressed, with cache headers.
//!
//! Names with a hash in them never change; `index.html` is fetched again each time. What has a file `NAME.gz` beside it is
//! sent from there to whoever takes gzip. A connection serves one request, in a thread of its own, so that none waits for another.

use std::fs;
use std::io::{self, BufRead as _, BufReader, Read as _, Write as _};
use std::net::{Ipv4Addr, SocketAddr, TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use anyhow::{Context, Result};

/// Longest request, bytes.
const LONGEST_REQUEST: u64 = 16 << 10;

/// A running server. It ends with the program.
pub struct Server {
    address: SocketAddr,
    sent: Arc<AtomicU64>,
    thread: JoinHandle<()>,
}

impl Server {
    /// Serves a folder on a port of the loopback interface; 0 is any that is free.
    ///
    /// # Errors
    /// When the port is taken.
    pub fn start(folder: PathBuf, port: u16) -> Result<Self> {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port))
            .with_context(|| format!("listen on port {port}"))?;
        let address = listener.local_addr().context("ask for the port")?;
        let sent = Arc::new(AtomicU64::new(0));
        let count = Arc::clone(&sent);
        let folder = Arc::new(folder);
        let thread = thread::spawn(move || {
            for stream in listener.incoming().flatten() {
                let (folder, count) = (Arc::clone(&folder), Arc::clone(&count));
                thread::spawn(move || {
                    // A browser that goes away is no error of the server.
                    if let Ok(bytes) = answer(&stream, &folder) {
                        count.fetch_add(bytes, Ordering::Relaxed);
                    }
                });
            }
        });
        Ok(Self { address, sent, thread })
    }

    /// Where it listens.
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// Bytes of all bodies sent so far, as they went over the wire.
    pub fn sent(&self) -> u64 {
        self.sent.load(Ordering::Relaxed)
    }

    /// Waits for its end, which does not come.
    pub fn wait(self) {
        let _ = self.thread.join();
    }
}

fn answer(stream: &TcpStream, folder: &Path) -> io::Result<u64> {
    stream.set_read_timeout(Some(Duration::from_secs(10)))?;
    let mut lines = BufReader::new(stream.take(LONGEST_REQUEST)).lines();
    let request = lines.next().transpose()?.unwrap_or_default();
    let mut compressed = false;
    for line in lines {
        let line = line?.to_ascii_lowercase();
        if line.is_empty() {
            break;
        }
        compressed |= line.starts_with("accept-encoding:") && line.contains("gzip");
    }
    let mut words = request.split(' ');
    let (method, path) = (words.next().unwrap_or_default(), words.next().unwrap_or_default());
    let Some(name) = ["GET", "HEAD"].contains(&method).then(|| file_name(path)).flatten() else {
        return respond(stream, "400 Bad Request", "text/plain", "", b"expected GET of a file", method)
            .map(|()| 0);
    };
    let zipped = compressed.then(|| fs::read(folder.join(format!("{name}.gz"))).ok()).flatten();
    let is_zipped = zipped.is_some();
    let Some(body) = zipped.or_else(|| fs::read(folder.join(name)).ok()) else {
        return respond(stream, "404 Not Found", "text/plain", "", b"no such file", method).map(|()| 0);
    };
    let mut more = if name == "index.html" {
        "Cache-Control: no-cache\r\n".to_owned()
    } else {
        "Cache-Control: public, max-age=31536000, immutable\r\n".to_owned()
    };
    more += "Vary: Accept-Encoding\r\n";
    if is_zipped {
        more += "Content-Encoding: gzip\r\n";
    }
    respond(stream, "200 OK", kind(name), &more, &body, method)?;
    Ok(body.len() as u64)
}

fn respond(
    mut stream: &TcpStream,
    status: &str,
    kind: &str,
    more: &str,
    body: &[u8],
    method: &str,
) -> io::Result<()> {
    let length = body.len();
    let head = format!(
        "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {length}\r\n{more}X-Content-Type-Options: nosniff\r\nConnection: close\r\n\r\n"
    );
    stream.write_all(head.as_bytes())?;
    if method != "HEAD" {
        stream.write_all(body)?;
    }
    stream.flush()
}

/// The file of a request: one name without folders, or `index.html`.
fn file_name(path: &str) -> Option<&str> {
    let path = path.split(['?', '#']).next()?.strip_prefix('/')?;
    let sound = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
    match path {
        "" => Some("index.html"),
        name if name.chars().all(sound) && !name.contains("..") => Some(name),
        _ => None,
    }
}

fn kind(name: &str) -> &'static str {
    match name.rsplit('.').next() {
        Some("html") => "text/html; charset=utf-8",
        Some("js") => "text/javascript; charset=utf-8",
        Some("css") => "text/css; charset=utf-8",
        Some("wasm") => "application/wasm",
        Some("glb") => "model/gltf-binary",
        _ => "application/octet-stream",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::workspace::ScratchFolder;

    fn ask(server: &Server, request: &str) -> String {
        let mut stream = TcpStream::connect(server.address()).unwrap();
        stream.write_all(request.as_bytes()).unwrap();
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).unwrap();
        String::from_utf8_lossy(&answer).into_owned()
    }

    #[test]
    fn files_of_the_folder_are_served_and_no_others() {
        let folder = ScratchFolder::new("server");
        fs::write(folder.path().join("index.html"), "<p>").unwrap();
        fs::write(folder.path().join("a.0123.wasm"), "wasm").unwrap();
        fs::write(folder.path().join("a.0123.wasm.gz"), "zipped").unwrap();
        let server = Server::start(folder.path().to_path_buf(), 0).unwrap();
        let page = ask(&server, "GET /?input=script HTTP/1.1\r\n\r\n");
        assert!(
            page.starts_with("HTTP/1.1 200") && page.ends_with("<p>") && page.contains("no-cache"),
            "{page}"
        );
        let wasm = ask(&server, "GET /a.0123.wasm HTTP/1.1\r\n\r\n");
        assert!(wasm.contains("application/wasm") && wasm.contains("immutable"), "{wasm}");
        let zipped = ask(&server, "GET /a.0123.wasm HTTP/1.1\r\nAccept-Encoding: gzip, br\r\n\r\n");
        assert!(zipped.contains("Content-Encoding: gzip") && zipped.ends_with("zipped"), "{zipped}");
        assert!(wasm.ends_with("wasm") && !wasm.contains("Content-Encoding"), "{wasm}");
        for bad in ["GET /../Cargo.toml", "GET /a/b", "POST /", "GET /%2e%2e", "", "\u{0}"] {
            assert!(ask(&server, &format!("{bad} HTTP/1.1\r\n\r\n")).starts_with("HTTP/1.1 400"), "{bad}");
        }
        assert!(ask(&server, "GET /none HTTP/1.1\r\n\r\n").starts_with("HTTP/1.1 404"));
        assert!(server.address().ip().is_loopback());
    }
}
