// Soft dark patches where bodies come near the ground: the stand-in for ambient occlusion on it.

struct Varying {
    @builtin(position) clip: vec4f,
    @location(0) uv: vec2f,
    @location(1) darkness: f32,
}

@vertex
fn vs_main(
    @builtin(vertex_index) index: u32,
    // xyz; w: how dark
    @location(0) centre: vec4f,
    @location(1) along: vec4f,
    @location(2) across: vec4f,
) -> Varying {
    let corner = vec2f(f32(index & 1u), f32(index >> 1u)) * 2.0 - 1.0;
    let position = centre.xyz + along.xyz * corner.x + across.xyz * corner.y;
    // Towards the eye, which moves nothing on the screen: uneven ground must not cut a flat patch.
    let lift = normalize(frame.eye.xyz - position) * 0.14 * length(along.xyz);
    return Varying(frame.clip_from_world * vec4f(position + lift, 1.0), corner, centre.w);
}

@fragment
fn fs_main(in: Varying) -> @location(0) vec4f {
    let inside = max(1.0 - dot(in.uv, in.uv), 0.0);
    return vec4f(0.0, 0.0, 0.0, in.darkness * inside * inside);
}
