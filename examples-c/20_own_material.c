/* 20_own_material: a column of clay collapses; its material is a model of your own, loaded from the library that is named first.
 *
 * The model is the template of plugins/template: linear elasticity with a von Mises cap, whose undrained shear strength in plane
 * strain is c = Y / sqrt(3). docs/book/write_a_material.md tells how to make your own. From the folder of the repository:
 *
 *   cc -std=c99 -O2 -Iinclude examples-c/20_own_material.c -Ltarget/release -llahar -Wl,-rpath,$PWD/target/release -lm -o own_column
 *   ./own_column ./libown_material.so
 *
 * The column stands by itself if rho g H / c is below 2, where its foot begins to yield. Far above it flows and becomes a layer, which
 * rests no sooner than the friction of its floor, at most c, carries it: it runs at least as far as h^2 = 2 c / (rho g) (L - x)
 * (J. F. Nye, J. Glaciol. 2, 82-93, 1952), where L follows from the volume. Inertia brings it farther.
 *
 * Further arguments, in any order:
 *   yield_stress=...   [Pa] (default: rho g H / c = 16)
 *   cells=...          cells along the width (default 24)
 *   steps=...          at most so many steps
 */

#include "check.h"
#include <math.h>
#include <string.h>

enum { OUTPUTS = 5 };

static const double width = 1.0, height = 1.0, density = 1800.0, gravity = 9.81; /* SI units */

/* Clay whose elastic waves are fifteen times as fast as a fall from half the height. */
static lahar_material *make_clay(lahar_context *context, double yield_stress) {
    const double wave_speed = 15.0 * sqrt(gravity * height), nu = 0.3;
    const double modulus = density * wave_speed * wave_speed;
    const char *names[] = {"youngs_modulus", "poissons_ratio", "yield_stress"};
    const double values[] = {modulus * (1.0 + nu) * (1.0 - 2.0 * nu) / (1.0 - nu), nu, yield_stress};
    lahar_material *clay;
    check(lahar_material_create(context, "own_material", 3, names, values, &clay));
    return clay;
}

/* A smooth wall at x = 0, the plane of symmetry, and a rough floor at y = 0. */
static lahar_world *make_world(lahar_context *context, double h) {
    lahar_world_options options;
    lahar_world *world;
    lahar_wall wall;
    check(lahar_world_options_init(&options, sizeof options));
    options.dimension = 2;
    options.spacing = h;
    options.gravity[1] = -gravity;
    check(lahar_world_create(context, &options, &world));
    check(lahar_wall_init(&wall, sizeof wall));
    wall.axis = 0;
    wall.kind = LAHAR_WALL_SLIP;
    check(lahar_wall_add(world, &wall, NULL));
    wall.axis = 1;
    wall.kind = LAHAR_WALL_STICKY;
    check(lahar_wall_add(world, &wall, NULL));
    return world;
}

/* Where the column ends, how high it stands at the wall, and how far it has been sheared. */
static void print_output(lahar_world *world, int64_t body, int64_t count, double h, int number) {
    double *position = doubles(2 * count), *strain = doubles(count);
    double time, front = 0.0, top = 0.0, largest = 0.0;
    char name[64];
    check(lahar_world_time(world, &time));
    check(lahar_body_read(world, body, "position", count, position, 0, 0));
    check(lahar_body_read(world, body, "equivalent_plastic_strain", count, strain, 0, 0));
    for (int64_t i = 0; i < count; ++i) {
        front = fmax(front, position[2 * i] + 0.25 * h);
        if (position[2 * i] < 2.0 * h) top = fmax(top, position[2 * i + 1] + 0.25 * h);
        largest = fmax(largest, strain[i]);
    }
    snprintf(name, sizeof name, "output%d_time", number);
    print(name, time);
    snprintf(name, sizeof name, "output%d_run_out", number);
    print(name, (front - width) / width);
    snprintf(name, sizeof name, "output%d_height", number);
    print(name, top / height);
    snprintf(name, sizeof name, "output%d_plastic_strain", number);
    print(name, largest);
    free(position);
    free(strain);
}

int main(int argc, char **argv) {
    const double weight = density * gravity, end_time = 6.0 * sqrt(height / gravity), low[3] = {0.0, 0.0, 0.0};
    const double high[3] = {1.0, 1.0, 0.0}; /* width, height */
    double yield_stress = sqrt(3.0) * weight * height / 16.0, potential;
    int64_t cells = 24, steps_left = INT64_MAX, steps, count, body;
    lahar_context *context;
    lahar_fill fill;
    lahar_totals totals;
    for (int i = 2; i < argc; ++i) {
        if (strncmp(argv[i], "yield_stress=", 13) == 0) yield_stress = atof(argv[i] + 13);
        else if (strncmp(argv[i], "cells=", 6) == 0) cells = atoll(argv[i] + 6);
        else if (strncmp(argv[i], "steps=", 6) == 0) steps_left = atoll(argv[i] + 6);
        else argc = 0;
    }
    if (argc < 2) {
        fprintf(stderr, "usage: own_column libown_material.so [yield_stress=...] [cells=...] [steps=...]\n");
        return 2;
    }

    check(lahar_context_create(0, &context));
    check(lahar_context_set_log(context, lahar_log_stderr, NULL, LAHAR_LOG_WARNING));
    check(lahar_context_load_plugin(context, argv[1], NULL)); /* a path: it has a slash */
    const double h = width / (double)cells, strength = yield_stress / sqrt(3.0);
    lahar_material *clay = make_clay(context, yield_stress);
    lahar_world *world = make_world(context, h);
    check(lahar_fill_init(&fill, sizeof fill));
    fill.density = density;
    check(lahar_body_add_box(world, clay, low, high, &fill, &body));
    check(lahar_body_set_f_bar(world, body, 1)); /* plastic flow keeps the volume: without F-bar it locks */
    check(lahar_body_particle_count(world, body, &count));
    totals.struct_size = sizeof totals;
    check(lahar_world_totals(world, body, &totals));
    potential = totals.potential_energy;
    print("particles", (double)count);
    print("weight_over_strength", weight * height / strength);

    for (int number = 1; number <= OUTPUTS; ++number) {
        check(lahar_world_advance(world, end_time * number / OUTPUTS, steps_left, &steps, NULL));
        if (steps_left < INT64_MAX) steps_left -= steps;
        print_output(world, body, count, h, number);
    }
    check(lahar_world_totals(world, body, &totals));
    check(lahar_world_step_count(world, &steps));
    print("steps", (double)steps);
    print("kinetic_over_start_potential", totals.kinetic_energy / potential);
    print("run_out_of_a_shallow_layer", pow(1.5 * width * height / sqrt(2.0 * strength / weight), 2.0 / 3.0) / width - 1.0);
    lahar_world_free(world);
    lahar_material_free(clay);
    lahar_context_free(context);
    return 0;
}
