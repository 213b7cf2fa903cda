//! MJCF that is malformed, hostile or no character is refused with an error that says where and why.

mod common;

use common::HUMANOID;
use physics_bridge::{Character, Model};
use policy_core::Skeleton;
use policy_core::training::{Roles, SkeletonBody, SkeletonJoint};

/// The error for the humanoid with one text replaced.
fn refused(from: &str, to: &str) -> String {
    assert!(HUMANOID.contains(from), "the MJCF has no {from:?}");
    Model::from_mjcf(&HUMANOID.replacen(from, to, 1)).unwrap_err().to_string()
}

fn assert_says(error: &str, words: &[&str]) {
    for word in words {
        assert!(error.contains(word), "expected {word:?} in {error:?}");
    }
}

#[test]
fn malformed_xml_is_refused_with_its_line() {
    assert_says(&refused("</worldbody>", "</worldbdy>"), &["XML", "worldb"]);
    assert_says(&refused("size=\".09\"", "sise=\".09\""), &["sise", "geom", "line 46"]);
    let long = "a".repeat(200);
    assert_says(
        &refused("<geom name=\"pelvis\"", &format!("<geom name=\"pelvis\" {long}=\"1\"")),
        &["line 46"],
    );
    assert_says(&refused("<light", "<unknown"), &["unknown", "line"]);
    assert!(Model::from_mjcf("").is_err());
    assert!(Model::from_mjcf("\0").is_err());
    assert!(Model::from_mjcf("<mujoco").is_err());
    assert!(Model::from_mjcf(&"<body>".repeat(5_000)).is_err());
}

#[test]
fn every_truncation_is_refused() {
    let end = HUMANOID.rfind("</mujoco>").unwrap();
    for length in (0..end).step_by(97).chain([end]) {
        assert!(Model::from_mjcf(&HUMANOID[..length]).is_err(), "cut off after {length} bytes");
    }
}

#[test]
fn bytes_that_are_not_text_are_refused() {
    let error = Model::from_mjcf_bytes(b"<mujoco>\xff</mujoco>").unwrap_err().to_string();
    assert_says(&error, &["UTF-8", "offset 8"]);
    assert!(Model::from_mjcf_bytes(HUMANOID.as_bytes()).is_ok());
}

#[test]
fn errors_name_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let missing = folder.path().join("missing.xml");
    assert_says(&Model::load(&missing).unwrap_err().to_string(), &["missing.xml"]);
    let broken = folder.path().join("broken.xml");
    std::fs::write(&broken, "<mujoco><worldbody><geom sise='1'/></worldbody></mujoco>").unwrap();
    assert_says(&Model::load(&broken).unwrap_err().to_string(), &["broken.xml", "sise", "line 1"]);
    let good = folder.path().join("good.xml");
    std::fs::write(&good, HUMANOID).unwrap();
    assert!(Model::load(&good).is_ok());
}

#[test]
fn what_is_no_character_is_refused_by_name() {
    assert_says(
        &Model::from_mjcf("<mujoco/>").unwrap_err().to_string(),
        &["one body with a free joint", "0"],
    );
    assert_says(&refused("body name=\"left_hand\"", "body"), &["name", "body number 9"]);
    assert_says(
        &refused("<position name=\"neck_x\" joint=\"neck_x\"", "<position name=\"neck_x\" joint=\"neck_y\""),
        &["unique", "neck_y"],
    );
    let neck = "<position name=\"neck_x\" joint=\"neck_x\" class=\"neck\" inheritrange=\"0\" ctrllimited=\"false\"/>";
    for (motor, word) in [
        ("<motor name='neck_x' joint='neck_x' forcerange='-50 50'/>", "position servo"),
        ("<position joint='neck_x' kp='50' kv='5' forcerange='-50 50'/>", "kv"),
        ("<position joint='neck_x' class='neck' gear='2'/>", "gear"),
        ("<position joint='neck_x' kp='50' forcerange='-50 70'/>", "forcerange"),
        ("<position joint='neck_x' kp='50' forcelimited='false'/>", "forcerange"),
    ] {
        assert_says(&refused(neck, motor), &["neck_x", word]);
    }
    assert_says(&refused(neck, ""), &["qpos", "34", "35"]);
    let ankle = "name=\"left_ankle_z\" axis=\"0 0 1\"";
    assert_says(
        &refused(ankle, "name=\"left_ankle_z\" type=\"slide\" axis=\"0 0 1\""),
        &["joint", "left_ankle_z", "hinge"],
    );
    assert_says(
        &refused(ankle, "name=\"left_ankle_z\" limited=\"false\" axis=\"0 0 1\""),
        &["joint", "left_ankle_z", "limited"],
    );
    assert_says(
        &refused("<light", "<body name=\"ball\"><freejoint/><geom size=\".1\"/></body><light"),
        &["one body with a free joint", "2"],
    );
    assert_says(&refused("<freejoint name=\"root\"/>", ""), &["qpos", "28", "35"]);
}

#[test]
fn what_is_not_the_given_skeleton_is_refused_by_name() {
    let given = |from: &str, to: &str| {
        assert!(HUMANOID.contains(from), "the MJCF has no {from:?}");
        let error = Model::from_mjcf_with_skeleton(&HUMANOID.replacen(from, to, 1), Skeleton::humanoid());
        error.unwrap_err().to_string()
    };
    Model::from_mjcf_with_skeleton(HUMANOID, Skeleton::humanoid()).unwrap();
    assert_says(&given("body name=\"left_hand\"", "body name=\"left_paw\""), &["body", "left_hand"]);
    assert_says(
        &given("axis=\"0 0 1\" range=\"-45 45\"", "axis=\"0 0 1\" range=\"-45 55\""),
        &["neck_z", "range"],
    );
    assert_says(
        &given("axis=\"0 0 1\" range=\"-45 45\"", "axis=\"0 1 1\" range=\"-45 45\""),
        &["neck_z", "axis"],
    );
    let quadruped = Model::from_mjcf_with_skeleton(common::QUADRUPED, Skeleton::humanoid());
    assert_says(&quadruped.unwrap_err().to_string(), &["15 bodies", "14"]);
    let nul = |name: &str| SkeletonBody { name: name.into(), parent: None };
    let body = |index: usize| policy_core::BodyId::new(index);
    let joint = SkeletonJoint { name: "a\0b".into(), body: body(0), axis: glam::Vec3::X, range: [0.0, 1.0] };
    let skeleton = Skeleton::from_parts(vec![nul("a\0b")], vec![joint], Roles::default()).unwrap();
    assert!(Model::from_mjcf_with_skeleton(HUMANOID, skeleton).is_err());
}

#[test]
fn ground_that_is_not_level_is_refused() {
    assert_says(&refused("name=\"floor\"", "name=\"flor\""), &["geom", "floor"]);
    assert_says(&refused("name=\"floor\"", "name=\"floor\" euler=\"5 0 0\""), &["floor", "level"]);
    assert_says(
        &refused("name=\"floor\" type=\"plane\" size=\"0 0 1\"", "name=\"floor\" type=\"sphere\" size=\"1\""),
        &["floor"],
    );
}

#[test]
fn options_that_cannot_be_stepped_are_refused() {
    assert_says(&refused("timestep=\"0.00833333\"", "timestep=\"0.0123\""), &["timestep", "0.0123"]);
    assert_says(&refused("integrator=\"implicitfast\"", "integrator=\"RK4\""), &["integrator", "RK4"]);
    assert_says(&refused("memory=\"4M\"", "memory=\"10K\""), &["memory", "10240"]);
    assert_says(&refused("memory=\"4M\"", "memory=\"4G\""), &["line 3", "memory", "4294967296"]);
}

#[test]
fn a_keyframe_that_is_no_pose_is_refused() {
    for bad in ["nan", "inf", "1e400"] {
        let error = refused("qpos=\"0 0 0.87", &format!("qpos=\"0 0 {bad}"));
        assert!(error.contains("stand") || error.contains("line"), "{bad}: {error}");
    }
}

/// The humanoid with something put in place of its light, which is on line 43.
fn with_element(element: &str) -> Result<Model, String> {
    let light = HUMANOID.lines().find(|line| line.contains("<light")).unwrap();
    Model::from_mjcf(&HUMANOID.replacen(light, element, 1)).map_err(|error| error.to_string())
}

/// The humanoid with something in front of its `worldbody`, on line 41.
fn with_section(section: &str) -> Result<Model, String> {
    Model::from_mjcf(&HUMANOID.replacen("<worldbody>", &format!("{section}<worldbody>"), 1))
        .map_err(|error| error.to_string())
}

#[test]
fn text_that_asks_for_files_never_reaches_mujoco() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("secret.xml");
    std::fs::write(&path, "<mujoco><geom name='secret' size='1'/></mujoco>").unwrap();
    let path = path.display();
    let sections = [
        format!("<include file='{path}'/>"),
        format!("< include\tfile = '{path}'/>"),
        format!("<asset><mesh name='m' file='{path}'/></asset>"),
        format!("<asset><hfield name='h' file='{path}' size='1 1 1 1'/></asset>"),
        format!("<asset><texture name='t' type='skybox' fileup='{path}'/></asset>"),
        format!("<asset><model name='m' file='{path}'/></asset>"),
        format!("<deformable><skin file='{path}'/></deformable>"),
        "<extension><plugin plugin='mujoco.sdf.torus'/></extension>".into(),
    ];
    for section in &sections {
        let error = with_section(section).unwrap_err();
        assert_says(&error, &["line 41", "stands alone"]);
        assert!(!error.contains("secret"), "{error}");
    }
    let robot = format!("<robot name='r'><link name='l'/><mesh filename='{path}'/></robot>");
    assert_says(&Model::from_mjcf(&robot).unwrap_err().to_string(), &["line 1", "mujoco"]);
}

#[test]
fn sizes_that_exhaust_memory_or_time_never_reach_mujoco() {
    let start = std::time::Instant::now();
    let asset = |text: &str| with_section(&format!("<asset>{text}</asset>"));
    let replicate = |count: &str| {
        with_element(&format!("<replicate count='{count}' offset='1 0 0'><geom size='.1'/></replicate>"))
    };
    let errors = [
        (asset("<hfield name='h' nrow='100000' ncol='100000' size='1 1 1 1'/>"), "nrow"),
        (asset("<texture type='2d' builtin='checker' width='100000' height='100000'/>"), "width"),
        (asset("<texture type='cube' builtin='checker' width='4000' height='24000'/>"), "bytes"),
        (asset("<mesh name='m' builtin='sphere' params='1000'/>"), "params"),
        (replicate("1000000000"), "count"),
        (replicate("1e9"), "count"),
        (replicate("nan"), "count"),
        (replicate("&#49;000000000"), "character references"),
        (
            with_element(
                "<replicate count='1000' offset='1 0 0'><replicate count='1000' offset='0 1 0'>\
                 <geom size='.1'/></replicate></replicate>",
            ),
            "copies",
        ),
        (with_element(&"<site/>".repeat(5000)), "elements"),
        (with_element(&"<geom size='.1'/>".repeat(1100)), "number"),
        (with_element("<body><flexcomp name='f' type='grid' count='1000 1000 1000'/></body>"), "flexcomp"),
        (with_element(&"<body><geom size='.1'/></body>".repeat(600)), "number"),
        (with_section("<custom><numeric name='n' size='1000000000'/></custom>"), "size"),
        (with_section("<size nuserdata='1000000000'/>"), "nuserdata"),
        (with_section("<size nkey='1000000000'/>"), "nkey"),
        (with_section("<size memory='100T'/>"), "memory"),
        (with_section("<sensor><user dim='1000000000'/></sensor>"), "dim"),
        (with_section("<option tolerance='0' iterations='1000000000'/>"), "iterations"),
        (with_section("<actuator><muscle joint='neck_x'/></actuator>"), "muscle"),
        (with_element(&("<body>".repeat(200) + &"</body>".repeat(200))), "nesting"),
    ];
    for (result, word) in errors {
        assert_says(&result.unwrap_err(), &["line 4", word]);
    }
    let long = format!("{HUMANOID}<!-- {} -->", "a".repeat(5 << 20));
    assert_says(&Model::from_mjcf(&long).unwrap_err().to_string(), &["bytes", "4194304"]);
    assert!(start.elapsed().as_secs() < 5, "{:?}", start.elapsed());
}

#[test]
fn sensible_sizes_still_load() {
    with_section("<asset><texture name='t' type='2d' builtin='checker' width='512' height='512'/></asset>")
        .unwrap();
    with_element("<replicate count='4' offset='5 0 0'><geom size='.1' pos='50 0 0'/></replicate>").unwrap();
    with_section("<size nkey='2'/>").unwrap();
}

/// MuJoCo ends the process when its working memory is full, so a model that could fill it is refused.
#[test]
fn crowded_models_are_refused_or_run() {
    let start = std::time::Instant::now();
    let parts = |count: usize, part: &dyn Fn(usize) -> String| (0..count).map(part).collect::<String>();
    let ball = "<geom size='.3' conaffinity='1'/>";
    let hinge = |i: usize| format!("<body name='w{i}'><joint name='j{i}' axis='0 1 0' range='-1 1'/>{ball}");
    let motors = |count| parts(count, &|i| format!("<position joint='j{i}' kp='5' forcerange='-5 5'/>"));
    let with = |bodies: &str, motors: &str| {
        let text = HUMANOID.replacen("<body name=\"head\"", &format!("{bodies}<body name=\"head\""), 1);
        let text = text.replacen("</actuator>", &format!("{motors}</actuator>"), 1);
        format!("{}</mujoco>", &text[..text.find("<keyframe>").unwrap()])
    };
    let models = [
        with(&ball.repeat(900), ""),
        with(&parts(200, &|i| format!("<body name='w{i}'>{ball}{ball}</body>")), ""),
        with(&parts(200, &|i| hinge(i) + "</body>"), &motors(200)),
        with(&(parts(80, &hinge) + &"</body>".repeat(80)), &motors(80)),
        HUMANOID.replacen("<light", &format!("{}<light", format!("<body>{ball}</body>").repeat(490)), 1),
        HUMANOID.replacen(
            "<light",
            &format!("{}<light", format!("<body pos='0 0 .9'>{ball}</body>").repeat(100)),
            1,
        ),
        HUMANOID.replacen("iterations=\"20\"", "iterations=\"1000\" tolerance=\"0\"", 1),
    ];
    for memory in ["1M", "4M", "64M"] {
        for text in &models {
            let text = text.replacen("memory=\"4M\"", &format!("memory=\"{memory}\""), 1);
            match Model::from_mjcf(&text) {
                Ok(model) => {
                    let mut character = Character::new(&model);
                    // It may diverge: what counts is that the process lives.
                    (0..3).for_each(|_| drop(character.step()));
                }
                Err(error) => assert_says(&error.to_string(), &["expected"]),
            }
        }
    }
    assert!(start.elapsed().as_secs() < 60, "{:?}", start.elapsed());
}

#[test]
fn messages_are_short_and_plain() {
    let hostile = [
        HUMANOID.replacen("<light", &format!("<light \u{1b}[2J{}='1'", "x".repeat(9000)), 1),
        HUMANOID.replacen("<light", &format!("<{}", "x".repeat(9000)), 1),
        HUMANOID.replacen("name=\"neck_x\" axis", &format!("name=\"\u{1b}[2J{}\" axis", "x".repeat(9000)), 1),
        HUMANOID.replacen("angle=\"degree\"", "angle=\"\u{1b}[2Jdegree\"", 1),
    ];
    for text in hostile {
        let message = Model::from_mjcf(&text).unwrap_err().to_string();
        assert!(message.len() < 1000 && !message.contains(char::is_control), "{message:?}");
    }
}

#[test]
fn causes_are_told_once() {
    let error = Model::load("/dev/null").unwrap_err();
    assert_says(&error.to_string(), &["/dev/null"]);
    let broken = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(broken.path(), "<mujoco>").unwrap();
    let error = Model::load(broken.path()).unwrap_err();
    assert!(std::error::Error::source(&error).is_none(), "the message of {error} holds its cause");
}
