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
    let p = vec4f(position, 1.0);
    let world = vec3f(dot(row_x, p), dot(row_y, p), dot(row_z, p));
    // Normals go by the inverse transpose; rows of a scaled rotation divide by their squared scale.
    let m = mat3x3f(
        vec3f(row_x.x, row_y.x, row_z.x),
        vec3f(row_x.y, row_y.y, row_z.y),
        vec3f(row_x.z, row_y.z, row_z.z),
    );
    let scale = vec3f(dot(m[0], m[0]), dot(m[1], m[1]), dot(m[2], m[2]));
    let turned = m * (normal / max(scale, vec3f(1e-9)));
    return Varying(frame.clip_from_world * vec4f(world, 1.0), turned, colour, world);
}

@fragment
fn fs_main(in: Varying) -> @location(0) vec4f {
    let normal = normalize(in.normal);
    let lit = 0.35 + 0.65 * max(dot(normal, frame.to_sun.xyz), 0.0) + 0.25 * (normal.z * 0.5 + 0.5);
    return vec4f(to_screen(in.colour.rgb * lit * 1.6), in.colour.a);
}
