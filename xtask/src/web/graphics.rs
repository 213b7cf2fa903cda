//! Browsers with more and with less.

/// What a page can draw with. The processor does it in both cases.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Graphics {
    /// WebGPU.
    WebGpu,
    /// WebGL2 alone, as in browsers without WebGPU.
    WebGl2,
    /// Neither.
    Nothing,
}

impl Graphics {
    /// What tells Chromium so.
    pub const fn flags(self) -> &'static [&'static str] {
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
            Graphics::Nothing => &["--disable-features=WebGPU", "--disable-3d-apis"],
        }
    }
}
