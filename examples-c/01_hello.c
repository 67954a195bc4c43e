/* 01_hello: a block falls, and its position is compared with g t^2 / 2.
 *
 * The objects of lahar in the order in which a host makes them: a context, a plugin loaded into it, a material of one of
 * the plugin's models, a world, a body. From the folder of the repository:
 *
 *   cc -std=c99 -Wall -Wextra -Werror -Iinclude examples-c/01_hello.c \
 *      -Ltarget/release -llahar -Wl,-rpath,$PWD/target/release -lm -o 01_hello
 *   LAHAR_PLUGIN_PATH=$PWD/target/release ./01_hello [number of steps, 1000 if not given]
 */

#include "check.h"

int main(int argc, char **argv) {
    const double gravity = 9.81, dt = 5e-4; /* [m/s^2], [s] */
    const int steps = argc > 1 ? atoi(argv[1]) : 1000;
    int32_t major, minor, patch, threads;

    /* A context: threads (0: as LAHAR_NUM_THREADS says, else 1), log, plugins. */
    lahar_context *context;
    check(lahar_context_create(0, &context));
    check(lahar_context_set_log(context, lahar_log_stderr, NULL, LAHAR_LOG_WARNING));
    check(lahar_context_thread_count(context, &threads));
    check(lahar_version(&major, &minor, &patch));
    print("version_major", major);
    print("version_minor", minor);
    print("version_patch", patch);
    print("abi_version", lahar_abi_version());
    print("threads", threads);

    /* A material: a model of a plugin with values of its parameters. */
    const char *names[] = {"youngs_modulus", "poissons_ratio"};
    const double values[] = {1e6, 0.3};
    lahar_material *rubber;
    check(lahar_context_load_plugin(context, "lahar_linear_elastic", NULL));
    check(lahar_material_create(context, "linear_elastic", 2, names, values, &rubber));

    /* A world in plane strain with cells of 0.1 m. There is no box: the grid follows the particles. */
    lahar_world_options options;
    lahar_world *world;
    check(lahar_world_options_init(&options, sizeof options));
    options.dimension = 2;
    options.spacing = 0.1;
    options.gravity[1] = -gravity;
    check(lahar_world_create(context, &options, &world));

    /* A body: a square of 1 m that hangs 5 m above the ground, 2 x 2 particles a cell. */
    const double low[3] = {0.0, 5.0, 0.0}, high[3] = {1.0, 6.0, 0.0};
    lahar_fill fill;
    int64_t body;
    check(lahar_fill_init(&fill, sizeof fill));
    fill.density = 1000.0;
    check(lahar_body_add_box(world, rubber, low, high, &fill, &body));

    lahar_totals start, end;
    double time, stable;
    start.struct_size = end.struct_size = sizeof(lahar_totals);
    check(lahar_world_totals(world, body, &start));
    check(lahar_world_stable_dt(world, &stable));
    print("particles", (double)start.particles);
    print("mass", start.mass);
    print("stable_dt", stable);
    print("start_x", start.center_of_mass[0]);
    print("start_y", start.center_of_mass[1]);

    for (int step = 0; step < steps; ++step) check(lahar_world_step(world, dt));

    /* Each step moves the body with its new velocity, hence falls g t dt / 2 further than g t^2 / 2. */
    check(lahar_world_totals(world, body, &end));
    check(lahar_world_time(world, &time));
    const double fall = start.center_of_mass[1] - end.center_of_mass[1];
    print("time", time);
    print("end_x", end.center_of_mass[0]);
    print("end_y", end.center_of_mass[1]);
    print("velocity_y", end.momentum[1] / end.mass);
    print("fall", fall);
    print("fall_exact", 0.5 * gravity * time * time);
    print("fall_of_the_scheme", 0.5 * gravity * time * (time + dt));

    lahar_world_free(world);
    lahar_material_free(rubber);
    lahar_context_free(context);
    return 0;
}
