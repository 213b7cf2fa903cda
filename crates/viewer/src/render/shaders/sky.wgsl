// The sky: one triangle over the whole picture, behind everything. Hills and towers on the horizon tell where one looks.

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

// How high a ridge is above the horizon in a direction, as a slope. It closes round the whole circle.
fn ridge(around: f32, turn: f32) -> f32 {
    let a = around + turn;
    return 0.045 + 0.020 * sin(3.0 * a) + 0.011 * sin(7.0 * a + 2.1) + 0.006 * sin(17.0 * a + 0.5)
        + 0.002 * sin(43.0 * a + 1.3);
}

// How much of a tower in the direction `at` covers a pixel that is `ahead` on the ground and `slope` above the horizon.
fn tower(ahead: vec2f, slope: f32, pixel: f32, at: vec2f, size: vec2f) -> f32 {
    let aside = abs(ahead.x * at.y - ahead.y * at.x);
    // Narrower towards the top, with a head.
    let top = slope / size.y;
    let width = size.x * select(1.0 - 0.5 * top, 1.25, top > 0.82);
    let inside = min(width - aside, size.y - slope);
    return clamp(inside / pixel + 0.5, 0.0, 1.0) * step(0.0, dot(ahead, at));
}

@fragment
fn fs_main(in: Varying) -> @location(0) vec4f {
    let direction = normalize(in.direction);
    let level = max(length(direction.xy), 1e-4);
    let slope = direction.z / level;
    let pixel = max(fwidth(slope), 1e-5);
    var light = sky(direction);
    // Nothing on the horizon is higher.
    if (slope < 0.2) {
        let ahead = direction.xy / level;
        let around = atan2(ahead.y, ahead.x);
        // The farther, the paler; haze lies at the foot of each.
        let haze = 1.0 - smoothstep(0.0, 0.045, slope);
        let far = mix(vec3f(0.26, 0.35, 0.48), frame.horizon.rgb, 0.25 + 0.35 * haze);
        let near = mix(vec3f(0.13, 0.21, 0.25), frame.horizon.rgb, 0.12 + 0.45 * haze);
        light = mix(light, far, clamp((1.5 * ridge(around, 0.0) - slope) / pixel + 0.5, 0.0, 1.0));
        var built = tower(ahead, slope, pixel, vec2f(0.9211, 0.3894), vec2f(0.012, 0.15));
        built = max(built, tower(ahead, slope, pixel, vec2f(-0.5048, 0.8632), vec2f(0.028, 0.11)));
        built = max(built, tower(ahead, slope, pixel, vec2f(-0.3233, -0.9463), vec2f(0.008, 0.18)));
        light = mix(light, mix(vec3f(0.20, 0.22, 0.27), frame.horizon.rgb, 0.15 + 0.4 * haze), built);
        light = mix(light, near, clamp((0.75 * ridge(around, 2.0) - slope) / pixel + 0.5, 0.0, 1.0));
    }
    return vec4f(to_screen(light), 1.0);
}
