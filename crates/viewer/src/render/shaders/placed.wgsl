// Where an instance of a solid puts a vertex, for shapes and things.

struct Placed {
    world: vec3f,
    normal: vec3f,
    half_size: vec3f,
}

fn placed(position: vec3f, normal: vec3f, row_x: vec4f, row_y: vec4f, row_z: vec4f) -> Placed {
    let p = vec4f(position, 1.0);
    let world = vec3f(dot(row_x, p), dot(row_y, p), dot(row_z, p));
    // Normals go by the inverse transpose; columns of a scaled rotation divide by their squared scale.
    let m = mat3x3f(
        vec3f(row_x.x, row_y.x, row_z.x),
        vec3f(row_x.y, row_y.y, row_z.y),
        vec3f(row_x.z, row_y.z, row_z.z),
    );
    let squared = vec3f(dot(m[0], m[0]), dot(m[1], m[1]), dot(m[2], m[2]));
    return Placed(world, m * (normal / max(squared, vec3f(1e-9))), sqrt(squared));
}
