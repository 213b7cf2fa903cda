//! A static server for one folder, on this machine only: GET and HEAD, compressed, with cache headers.
//!
//! Names with a hash in them never change; `index.html` is fetched again each time. What has a file `NAME.gz` beside it is
//! sent from there to whoever takes gzip.

use std::fs::{self, File};
use std::net::{Ipv4Addr, SocketAddr};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread::{self, JoinHandle};

use anyhow::{Context, Result, anyhow};
use tiny_http::{Header, Method, Request, Response};

/// Requests that are met at once: a browser asks for the files of the page side by side.
const THREADS: usize = 4;

/// A running server. It ends with the program.
pub struct Server {
    address: SocketAddr,
    sent: Arc<AtomicU64>,
    threads: Vec<JoinHandle<()>>,
}

impl Server {
    /// Serves a folder on a port of the loopback interface; 0 is any that is free.
    ///
    /// # Errors
    /// When the port is taken.
    pub fn start(folder: PathBuf, port: u16) -> Result<Self> {
        let server = tiny_http::Server::http((Ipv4Addr::LOCALHOST, port))
            .map_err(|error| anyhow!("{error}"))
            .with_context(|| format!("listen on port {port}"))?;
        let address = server.server_addr().to_ip().context("ask for the port")?;
        let (server, sent, folder) = (Arc::new(server), Arc::new(AtomicU64::new(0)), Arc::new(folder));
        let thread = |_| {
            let (server, sent, folder) = (Arc::clone(&server), Arc::clone(&sent), Arc::clone(&folder));
            thread::spawn(move || {
                while let Ok(request) = server.recv() {
                    respond(request, &folder, &sent);
                }
            })
        };
        Ok(Self { address, threads: (0..THREADS).map(thread).collect(), sent })
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
        for thread in self.threads {
            let _ = thread.join();
        }
    }
}

fn respond(request: Request, folder: &Path, sent: &AtomicU64) {
    let takes_gzip = request
        .headers()
        .iter()
        .any(|header| header.field.equiv("Accept-Encoding") && header.value.as_str().contains("gzip"));
    let name = [Method::Get, Method::Head].contains(request.method()).then(|| file_name(request.url()));
    let found = match name.flatten() {
        None => Err((400, "expected GET of a file")),
        Some(name) => open(folder, name, takes_gzip).map(|found| (name, found)).ok_or((404, "no such file")),
    };
    // A browser that goes away is no error of the server.
    let _ = match found {
        Err((status, text)) => request.respond(Response::from_string(text).with_status_code(status)),
        Ok((name, (file, length, zipped))) => {
            let headers = headers(name, zipped);
            let sends = *request.method() == Method::Get;
            let result = request.respond(Response::new(200.into(), headers, file, Some(length), None));
            if sends && result.is_ok() {
                sent.fetch_add(length as u64, Ordering::Relaxed);
            }
            result
        }
    };
}

/// A file, its length, and whether it is compressed.
fn open(folder: &Path, name: &str, takes_gzip: bool) -> Option<(File, usize, bool)> {
    let plain = folder.join(name);
    let zipped = folder.join(format!("{name}.gz"));
    let (path, is_zipped) = if takes_gzip && zipped.is_file() { (zipped, true) } else { (plain, false) };
    let length = fs::metadata(&path).ok().filter(std::fs::Metadata::is_file)?.len();
    Some((File::open(path).ok()?, length as usize, is_zipped))
}

fn headers(name: &str, zipped: bool) -> Vec<Header> {
    let cache = if name == "index.html" { "no-cache" } else { "public, max-age=31536000, immutable" };
    let mut headers = vec![
        ("Content-Type", kind(name)),
        ("Cache-Control", cache),
        ("X-Content-Type-Options", "nosniff"),
        ("Vary", "Accept-Encoding"),
    ];
    if zipped {
        headers.push(("Content-Encoding", "gzip"));
    }
    headers.into_iter().filter_map(|(field, value)| Header::from_bytes(field, value).ok()).collect()
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
    use std::io::{Read as _, Write as _};
    use std::net::TcpStream;

    use super::*;
    use crate::workspace::ScratchFolder;

    fn ask(server: &Server, request: &str) -> String {
        let mut stream = TcpStream::connect(server.address()).unwrap();
        write!(stream, "{request} HTTP/1.1\r\nHost: a\r\nConnection: close\r\n\r\n").unwrap();
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
        fs::create_dir(folder.path().join("folder")).unwrap();
        let server = Server::start(folder.path().to_path_buf(), 0).unwrap();
        let page = ask(&server, "GET /?input=script");
        assert!(
            page.starts_with("HTTP/1.1 200") && page.ends_with("<p>") && page.contains("no-cache"),
            "{page}"
        );
        let wasm = ask(&server, "GET /a.0123.wasm");
        assert!(wasm.contains("application/wasm") && wasm.contains("immutable"), "{wasm}");
        assert!(wasm.ends_with("wasm") && !wasm.contains("Content-Encoding"), "{wasm}");
        let zipped = ask(&server, "GET /a.0123.wasm HTTP/1.1\r\nAccept-Encoding: gzip, br\r\nX:");
        assert!(zipped.contains("Content-Encoding: gzip") && zipped.ends_with("zipped"), "{zipped}");
        for bad in ["GET /../Cargo.toml", "GET /a/b", "POST /", "GET /%2e%2e"] {
            let said = ask(&server, bad);
            assert!(said.starts_with("HTTP/1.1 400"), "{bad}: {said}");
        }
        for none in ["GET /none", "GET /folder"] {
            let said = ask(&server, none);
            assert!(said.starts_with("HTTP/1.1 404"), "{none}: {said}");
        }
        assert_eq!(server.sent(), 3 + 4 + 6);
        assert!(server.address().ip().is_loopback());
    }
}
