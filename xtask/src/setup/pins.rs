//! The native libraries that the project fetches, each pinned to one version and one hash per platform.
//!
//! Both come out of wheels of the Python package index: a wheel is a zip file, and the library inside is the
//! one that the project's own makers built. Nothing of Python is used from it.

/// One build of a native library: which wheel holds it and what it must hash to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Build {
    /// `std::env::consts::OS` of the machines it runs on.
    pub os: &'static str,
    /// `std::env::consts::ARCH` of the machines it runs on.
    pub arch: &'static str,
    /// Platform tags that make pip choose this wheel, on whatever machine pip runs.
    pub tags: &'static [&'static str],
    /// sha256 of the wheel, lower-case hexadecimal.
    pub wheel_sha256: &'static str,
    /// Path of the library inside the wheel.
    pub library: &'static str,
    /// sha256 of the library.
    pub library_sha256: &'static str,
    /// Further names, relative to the `lib` folder, under which linkers and loaders look for the library.
    pub links: &'static [&'static str],
}

impl Build {
    /// File name of the library, without its folder in the wheel.
    pub fn library_name(&self) -> &'static str {
        self.library.rsplit('/').next().unwrap_or(self.library)
    }
}

/// A native library at one version, for every platform that has a build of it.
#[derive(Debug, Clone, Copy)]
pub struct NativeLibrary {
    /// Name of the package that holds it, also of its folder under `third_party`.
    pub package: &'static str,
    /// The pinned version.
    pub version: &'static str,
    /// Folder of the wheel that holds C headers, if it has one.
    pub headers: Option<&'static str>,
    /// Environment variable that names a wheel that is already on this machine.
    pub wheel_variable: &'static str,
    /// One entry per platform.
    pub builds: &'static [Build],
}

impl NativeLibrary {
    /// The build for a platform, `None` where the package offers none.
    pub fn build(&self, os: &str, arch: &str) -> Option<&'static Build> {
        self.builds.iter().find(|build| build.os == os && build.arch == arch)
    }
}

const MACOS_LINKS: &[&str] = &["libmujoco.dylib", "mujoco.framework/Versions/A/libmujoco.3.17.0.dylib"];

/// MuJoCo, the physics engine.
///
/// The macOS library is a universal one: the wheel made for arm64 serves Intel machines as well, for which the
/// index has no wheel of this version.
pub const MUJOCO: NativeLibrary = NativeLibrary {
    package: "mujoco",
    version: "3.17.0",
    headers: Some("mujoco/include/"),
    wheel_variable: "POLICY_SPACE_MUJOCO_WHEEL",
    builds: &[
        Build {
            os: "linux",
            arch: "x86_64",
            tags: &["manylinux_2_28_x86_64", "manylinux_2_27_x86_64"],
            wheel_sha256: "42371356efe53a5f5f73ed03fcb967bdf04048017f80e2fca01e71a360e42da2",
            library: "mujoco/libmujoco.so.3.17.0",
            library_sha256: "23496b023ee80fb61ab71167e94bc649f9941710fde96b18bb8204fb332523ad",
            links: &["libmujoco.so"],
        },
        Build {
            os: "linux",
            arch: "aarch64",
            tags: &["manylinux_2_28_aarch64", "manylinux_2_27_aarch64"],
            wheel_sha256: "525e09a00ecd964f06582773d9eeb03bb0e5a1675edf296a6868024759b3b235",
            library: "mujoco/libmujoco.so.3.17.0",
            library_sha256: "e2edd0204fb9229f75f332a4fcd1a32345bb9f90651dc0fddfa20ec0670db789",
            links: &["libmujoco.so"],
        },
        Build {
            os: "macos",
            arch: "aarch64",
            tags: &["macosx_11_0_arm64"],
            wheel_sha256: "c677ab789299db70ca3fffe96b44a424bdad516cc87cc2a83898140923c2e91e",
            library: "mujoco/libmujoco.3.17.0.dylib",
            library_sha256: "454d51fa639100018579716bd68e61285e9b53c9241b029680d82dec95bc8d53",
            links: MACOS_LINKS,
        },
        Build {
            os: "macos",
            arch: "x86_64",
            tags: &["macosx_11_0_arm64"],
            wheel_sha256: "c677ab789299db70ca3fffe96b44a424bdad516cc87cc2a83898140923c2e91e",
            library: "mujoco/libmujoco.3.17.0.dylib",
            library_sha256: "454d51fa639100018579716bd68e61285e9b53c9241b029680d82dec95bc8d53",
            links: MACOS_LINKS,
        },
        Build {
            os: "windows",
            arch: "x86_64",
            tags: &["win_amd64"],
            wheel_sha256: "17ab707e86b0a5da13582a5335d3ea585a5ac4cce2e814e15b203530d1bf16e3",
            library: "mujoco/mujoco.dll",
            library_sha256: "c395db1b3f5110a730c4b0c31b7a4f29881af459c8a74a03e14b7683f022d57f",
            links: &[],
        },
    ],
};

/// ONNX Runtime, one of the peers of `cargo xtask bench policy`; nothing else needs it.
pub const ONNX_RUNTIME: NativeLibrary = NativeLibrary {
    package: "onnxruntime",
    version: "1.31.0",
    headers: None,
    wheel_variable: "POLICY_SPACE_ONNXRUNTIME_WHEEL",
    builds: &[
        Build {
            os: "linux",
            arch: "x86_64",
            tags: &["manylinux_2_28_x86_64", "manylinux_2_27_x86_64"],
            wheel_sha256: "5e129d6c56abd53e659cb70f00a108d6824086470ff99c2e47a82e5786563db3",
            library: "onnxruntime/capi/libonnxruntime.so.1.31.0",
            library_sha256: "21901b1b02233484b80888c16f4f5473742f796bf5528d5d0c4073dbe9802001",
            links: &[],
        },
        Build {
            os: "linux",
            arch: "aarch64",
            tags: &["manylinux_2_28_aarch64", "manylinux_2_27_aarch64"],
            wheel_sha256: "35758d7606d578ec5b9d65f6e8a1f488013194c3f6097038a3223cb26d35ef9a",
            library: "onnxruntime/capi/libonnxruntime.so.1.31.0",
            library_sha256: "b79d2fcf36b8870f4b2da95784a6ad846c47f05511ffa7be409c79a44f9dc9a4",
            links: &[],
        },
        Build {
            os: "macos",
            arch: "aarch64",
            tags: &["macosx_14_0_arm64"],
            wheel_sha256: "aaab9b3af536b06ca27ab5e35e3d429c97457ce76cf298af103f687e8b9975c0",
            library: "onnxruntime/capi/libonnxruntime.1.31.0.dylib",
            library_sha256: "ff52828ce7c6dd1aea99a5e9f5da9e2786e3d03e467fbf8b6893a4b624334920",
            links: &[],
        },
        Build {
            os: "windows",
            arch: "x86_64",
            tags: &["win_amd64"],
            wheel_sha256: "09d56445c1753e66e0912de69d3f0184016ad9a191dcd6925bf5dd570d2bfbe5",
            library: "onnxruntime/capi/onnxruntime.dll",
            library_sha256: "aa7737cc5c987286f09f6f12304fa786ea697b11b4ca7ab59a027ff4ce343a9c",
            links: &[],
        },
    ],
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pin_is_a_whole_sha256() {
        for library in [MUJOCO, ONNX_RUNTIME] {
            for build in library.builds {
                for hash in [build.wheel_sha256, build.library_sha256] {
                    let hexadecimal = hash.bytes().all(|byte| matches!(byte, b'0'..=b'9' | b'a'..=b'f'));
                    assert!(
                        hash.len() == 64 && hexadecimal,
                        "{} {} {}",
                        library.package,
                        build.os,
                        build.arch
                    );
                }
                assert!(
                    build.library.contains(library.version) || build.os == "windows",
                    "{} is not version {}",
                    build.library,
                    library.version
                );
            }
        }
    }

    #[test]
    fn a_platform_without_a_build_is_none() {
        assert!(MUJOCO.build("linux", "x86_64").is_some());
        assert!(MUJOCO.build("linux", "riscv64").is_none());
        assert!(ONNX_RUNTIME.build("macos", "x86_64").is_none());
    }
}
