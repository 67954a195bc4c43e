//! Sizes and offsets of the public structs on 64-bit systems: asserted here, and by both headers
//! from this list.

/// `name: size { field: offset, ... }`; the header generator reads these lines.
macro_rules! layout {
    ($module:path, $($name:ident: $size:literal { $($field:ident: $offset:literal),* $(,)? })*) => {
        const _: () = {
            use $module::*;
            $(
                assert!(size_of::<$name>() == $size);
                $(assert!(std::mem::offset_of!($name, $field) == $offset);)*
            )*
        };
    };
}

#[cfg(target_pointer_width = "64")]
layout! {
    super::public,
    lahar_error_info: 48 {
        struct_size: 0, code: 4, body: 8, particle: 16, step: 24, time: 32, suggested_dt: 40,
    }
    lahar_plugin_info: 64 {
        struct_size: 0, reserved: 4, model_count: 8, id: 16, version: 24, author: 32, licence: 40,
        url: 48, path: 56,
    }
    lahar_model_info: 72 {
        struct_size: 0, kinematics: 4, name: 8, summary: 16, reference: 24, plugin: 32,
        parameter_count: 40, state_count: 48, outputs: 56, capabilities: 64,
    }
    lahar_parameter_info: 96 {
        struct_size: 0, kind: 4, required: 8, reserved: 12, name: 16, symbol: 24, unit: 32,
        description: 40, choices: 48, default_value: 56, hard_min: 64, hard_max: 72,
        advised_min: 80, advised_max: 88,
    }
    lahar_state_info: 48 {
        struct_size: 0, kind: 4, components: 8, rotation: 12, name: 16, unit: 24, description: 32,
        initial: 40,
    }
    lahar_world_options: 176 {
        struct_size: 0, dimension: 4, shape: 8, transfer: 12, order: 16, grid_policy: 20,
        spacing: 24, origin: 32, pic_rate: 56, cfl: 64, gravity: 72, damping: 96, box_min: 104,
        box_max: 128, wall_treatment: 152, axisymmetric: 156, filter_order: 160, body_force: 164,
        retries: 168, reserved: 172,
    }
    lahar_array: 24 {
        data: 0, component_stride: 8, point_stride: 16,
    }
    lahar_particles: 168 {
        struct_size: 0, reserved: 4, count: 8, position: 16, volume: 40, mass: 64, velocity: 88,
        stress: 112, density: 136, size: 144,
    }
    lahar_fill: 96 {
        struct_size: 0, particles_per_cell: 4, density: 8, mass: 16, velocity: 24, stress: 48,
    }
    lahar_field_info: 40 {
        struct_size: 0, components: 4, writable: 8, reserved: 12, name: 16, unit: 24,
        description: 32,
    }
    lahar_wall: 32 {
        struct_size: 0, axis: 4, side: 8, kind: 12, position: 16, friction: 24,
    }
    lahar_table: 24 {
        count: 0, times: 8, values: 16,
    }
    lahar_prescribed_velocity: 104 {
        struct_size: 0, components: 4, box_min: 8, box_max: 32, velocity: 56, table: 80,
    }
    lahar_traction: 120 {
        struct_size: 0, axis: 4, side: 8, reserved: 12, body: 16, box_min: 24, box_max: 48,
        traction: 72, factors: 96,
    }
    lahar_equilibrium: 56 {
        struct_size: 0, reserved: 4, kinetic_energy: 8, strain_energy: 16, kinetic_ratio: 24,
        unbalanced_force: 32, external_force: 40, unbalanced_ratio: 48,
    }
    lahar_settle_criteria: 40 {
        struct_size: 0, reserved: 4, kinetic_ratio: 8, unbalanced_ratio: 16, max_steps: 24, until: 32,
    }
    lahar_settle_result: 40 {
        struct_size: 0, converged: 4, steps: 8, time: 16, kinetic_ratio: 24, unbalanced_ratio: 32,
    }
    lahar_view_info: 40 {
        struct_size: 0, components: 4, data: 8, count: 16, stride: 24, generation: 32,
    }
    lahar_grid_statistics: 56 {
        struct_size: 0, dimension: 4, block_edge: 8, active_blocks: 16, active_nodes: 24,
        bytes: 32, blocks_created: 40, blocks_removed: 48,
    }
    lahar_totals: 120 {
        struct_size: 0, reserved: 4, particles: 8, mass: 16, momentum: 24, angular_momentum: 48,
        kinetic_energy: 72, strain_energy: 80, potential_energy: 88, center_of_mass: 96,
    }
}

#[cfg(target_pointer_width = "64")]
layout! {
    lahar_plugin_abi,
    lahar_host_api: 32 {
        struct_size: 0, abi_minor: 4, log: 8, set_error: 16, should_stop: 24,
    }
    lahar_parameter_desc: 88 {
        key: 0, symbol: 8, unit: 16, description: 24, kind: 32, required: 36, default_value: 40,
        hard_min: 48, hard_max: 56, advised_min: 64, advised_max: 72, choices: 80,
    }
    lahar_state_desc: 40 {
        key: 0, unit: 8, description: 16, kind: 24, rotation: 28, initial: 32,
    }
    lahar_stress_batch: 152 {
        struct_size: 0, flags: 4, n: 8, stride: 16, dt: 24, time: 32, step: 40,
        strain_increment: 48, velocity_gradient: 56, deformation_gradient: 64, stress0: 72,
        state0: 80, stress1: 88, state1: 96, inputs: 104, wave_speed: 112, diffusivity: 120,
        energy: 128, dt_factor: 136, status: 144,
    }
    lahar_model_desc: 152 {
        struct_size: 0, kinematics: 4, name: 8, summary: 16, reference: 24, parameter_count: 32,
        parameter_size: 36, parameters: 40, state_count: 48, state_size: 52, states: 56,
        input_count: 64, required_minor: 68, inputs: 72, outputs: 80, capabilities: 88, create: 96,
        destroy: 104, check: 112, init_state: 120, update: 128, wave_speed: 136,
        get_extension: 144,
    }
    lahar_tangent_extension: 16 { struct_size: 0, reserved: 4, tangent: 8 }
    lahar_energy_extension: 16 { struct_size: 0, reserved: 4, stored: 8 }
    lahar_transfer_extension: 16 { struct_size: 0, count: 4, rules: 8 }
    lahar_plugin_desc: 64 {
        struct_size: 0, abi_major: 4, abi_minor: 8, model_count: 12, id: 16, version: 24,
        author: 32, licence: 40, url: 48, models: 56,
    }
}
