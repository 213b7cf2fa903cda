// The characters: skinned on the way through the vertex stage, all of them in one draw call a material.

struct Material {
    // w: roughness
    colour: vec4f,
    // x: metallic, y: 1 where tinted
    more: vec4f,
}

// Three rows for each joint, row by row 1024 texels wide. A texture, because WebGL2 has no storage buffers.
@group(2) @binding(0) var palette: texture_2d<f32>;
@group(3) @binding(0) var<uniform> material: Material;

struct Vertex {
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(2) colour: vec4f,
    @location(3) joints: vec4u,
    @location(4) share: vec4f,
    // Of the whole character: colour of its clothes, w: how much of it;
    @location(5) tint: vec4f,
    // height of the ground below it;
    @location(6) ground: f32,
    // its first joint in the palette.
    @location(7) first: u32,
}

struct Varying {
    @builtin(position) clip: vec4f,
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(2) colour: vec3f,
    @location(3) @interpolate(flat) tint: vec4f,
    @location(4) @interpolate(flat) ground: f32,
}

struct Rows {
    x: vec4f,
    y: vec4f,
    z: vec4f,
}

fn palette_row(index: u32) -> vec4f {
    return textureLoad(palette, vec2u(index & 1023u, index >> 10u), 0);
}

fn joint(index: u32, share: f32, rows: Rows) -> Rows {
    let row = index * 3u;
    return Rows(
        rows.x + palette_row(row) * share,
        rows.y + palette_row(row + 1u) * share,
        rows.z + palette_row(row + 2u) * share,
    );
}

fn bend(vertex: Vertex) -> Rows {
    let index = vertex.first + vertex.joints;
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
fn vs_main(vertex: Vertex) -> Varying {
    let rows = bend(vertex);
    let position = place(rows, vec4f(vertex.position, 1.0));
    let normal = place(rows, vec4f(vertex.normal, 0.0));
    let clip = frame.clip_from_world * vec4f(position, 1.0);
    return Varying(clip, position, normal, vertex.colour.rgb, vertex.tint, vertex.ground);
}

@vertex
fn vs_shadow(vertex: Vertex) -> @builtin(position) vec4f {
    let position = place(bend(vertex), vec4f(vertex.position, 1.0));
    return frame.sun_clip_from_world * vec4f(position, 1.0);
}

@fragment
fn fs_main(in: Varying) -> @location(0) vec4f {
    let normal = normalize(in.normal);
    let colour = mix(material.colour.rgb, in.tint.rgb, in.tint.w * material.more.y);
    // Near the ground, what faces down sees the character's own shadow rather than the sky.
    let height = max(in.position.z - in.ground, 0.0);
    let below = mix(1.0, smoothstep(-0.15, 0.9, height), 0.75 * (0.5 - 0.5 * normal.z));
    let open = in.colour.r * below;
    return vec4f(to_screen(shade(in.position, normal, colour, material.colour.w, material.more.x, open)), 1.0);
}
