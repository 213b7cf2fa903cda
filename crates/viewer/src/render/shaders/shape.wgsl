// Simple solids in one colour each: collision shapes, markers, arrows.

struct Varying {
    @builtin(position) clip: vec4f,
    @location(0) normal: vec3f,
    @location(1) colour: vec4f,
    @location(2) position: vec3f,
}

@vertex
fn vs_main(
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(2) row_x: vec4f,
    @location(3) row_y: vec4f,
    @location(4) row_z: vec4f,
    @location(5) colour: vec4f,
) -> Varying {
    let at = placed(position, normal, row_x, row_y, row_z);
    return Varying(frame.clip_from_world * vec4f(at.world, 1.0), at.normal, colour, at.world);
}

@fragment
fn fs_main(in: Varying) -> @location(0) vec4f {
    let normal = normalize(in.normal);
    let lit = 0.35 + 0.65 * max(dot(normal, frame.to_sun.xyz), 0.0) + 0.25 * (normal.z * 0.5 + 0.5);
    return vec4f(to_screen(in.colour.rgb * lit * 1.6), in.colour.a);
}
