// Flat coloured triangles in the world: trails and lines.

struct Varying {
    @builtin(position) clip: vec4f,
    @location(0) colour: vec4f,
}

@vertex
fn vs_main(@location(0) position: vec3f, @location(1) colour: vec4f) -> Varying {
    return Varying(frame.clip_from_world * vec4f(position, 1.0), colour);
}

@fragment
fn fs_main(in: Varying) -> @location(0) vec4f {
    return vec4f(to_screen(in.colour.rgb), in.colour.a);
}
