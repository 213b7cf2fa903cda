// The sky: one triangle over the whole picture, behind everything.

struct Varying {
    @builtin(position) clip: vec4f,
    // From the eye; straight lines on the screen are straight lines of it.
    @location(0) direction: vec3f,
}

@vertex
fn vs_main(@builtin(vertex_index) index: u32) -> Varying {
    let at = vec2f(f32(index & 1u), f32(index >> 1u)) * 4.0 - 1.0;
    let far = frame.world_from_clip * vec4f(at, 1.0, 1.0);
    return Varying(vec4f(at, 1.0, 1.0), far.xyz / far.w - frame.eye.xyz);
}

@fragment
fn fs_main(in: Varying) -> @location(0) vec4f {
    return vec4f(to_screen(sky(normalize(in.direction))), 1.0);
}
