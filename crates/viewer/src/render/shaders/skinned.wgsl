// The characters: skinned on the way through the vertex stage, all of them in one draw call a material.

struct Instance {
    // colour of its clothes; w: how much of it
    tint: vec4f,
    // height of the ground below; first joint in the palette
    ground: f32,
    first: u32,
    padding: vec2u,
}

struct Material {
    // w: roughness
    colour: vec4f,
    // x: metallic, y: 1 where tinted
    more: vec4f,
}

@group(2) @binding(0) var<storage, read> instances: array<Instance>;
// Three rows for each joint.
@group(2) @binding(1) var<storage, read> palette: array<vec4f>;
@group(3) @binding(0) var<uniform> material: Material;

struct Vertex {
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(2) colour: vec4f,
    @location(3) joints: vec4u,
    @location(4) share: vec4f,
}

struct Varying {
    @builtin(position) clip: vec4f,
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(2) colour: vec3f,
    @location(3) @interpolate(flat) instance: u32,
}

struct Rows {
    x: vec4f,
    y: vec4f,
    z: vec4f,
}

fn joint(index: u32, share: f32, rows: Rows) -> Rows {
    let row = index * 3u;
    return Rows(
        rows.x + palette[row] * share,
        rows.y + palette[row + 1u] * share,
        rows.z + palette[row + 2u] * share,
    );
}

fn bend(vertex: Vertex, instance: u32) -> Rows {
    let index = instances[instance].first + vertex.joints;
    var rows = joint(index.x, vertex.share.x, Rows(vec4f(), vec4f(), vec4f()));
    if vertex.share.x < 1.0 {
        rows = joint(index.y, vertex.share.y, rows);
        rows = joint(index.z, vertex.share.z, rows);
        rows = joint(index.w, vertex.share.w, rows);
    }
    return rows;
}

fn place(rows: Rows, v: vec4f) -> vec3f {
    return vec3f(dot(rows.x, v), dot(rows.y, v), dot(rows.z, v));
}

@vertex
fn vs_main(vertex: Vertex, @builtin(instance_index) instance: u32) -> Varying {
    let rows = bend(vertex, instance);
    let position = place(rows, vec4f(vertex.position, 1.0));
    let normal = place(rows, vec4f(vertex.normal, 0.0));
    return Varying(frame.clip_from_world * vec4f(position, 1.0), position, normal, vertex.colour.rgb, instance);
}

@vertex
fn vs_shadow(vertex: Vertex, @builtin(instance_index) instance: u32) -> @builtin(position) vec4f {
    let position = place(bend(vertex, instance), vec4f(vertex.position, 1.0));
    return frame.sun_clip_from_world * vec4f(position, 1.0);
}

@fragment
fn fs_main(in: Varying) -> @location(0) vec4f {
    let normal = normalize(in.normal);
    let tint = instances[in.instance].tint;
    let colour = mix(material.colour.rgb, tint.rgb, tint.w * material.more.y);
    // Near the ground, what faces down sees the character's own shadow rather than the sky.
    let height = max(in.position.z - instances[in.instance].ground, 0.0);
    let below = mix(1.0, smoothstep(-0.15, 0.9, height), 0.75 * (0.5 - 0.5 * normal.z));
    let open = in.colour.r * below;
    return vec4f(to_screen(shade(in.position, normal, colour, material.colour.w, material.more.x, open)), 1.0);
}
