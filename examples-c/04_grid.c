/* 04_grid: a disc is thrown; the host looks at the sparse grid that follows it.
 *
 * The grid has no box. It is made of blocks of nodes, which come and go with the particles. This driver asks how large it
 * is, walks through its blocks and nodes, adds up mass and momentum of the nodes, which are those of the particles, and
 * samples the velocity at points, as a host does that couples another method to the material.
 *
 * New here: statistics, blocks, node numbers, node fields, samples. Compile as told in 01_hello.c, run with
 *   04_grid [number of steps, 500 if not given]
 */

#include "check.h"
#include <math.h>

enum { DIMENSION = 2 };

static int64_t *integers(int64_t count) {
    int64_t *memory = (int64_t *)malloc((size_t)count * sizeof(int64_t));
    if (memory != NULL) return memory;
    fprintf(stderr, "no memory for %lld integers\n", (long long)count);
    exit(1);
}

static lahar_grid_statistics grid_of(const lahar_world *world) {
    lahar_grid_statistics grid;
    grid.struct_size = sizeof grid;
    check(lahar_grid_stats(world, &grid));
    return grid;
}

/* Throws the disc. Its grid moves with it: blocks appear in front and go behind. */
static void throw_it(lahar_world *world, int steps, double dt) {
    int64_t created = 0, removed = 0, most = 0;
    for (int step = 0; step < steps; ++step) {
        check(lahar_world_step(world, dt));
        const lahar_grid_statistics grid = grid_of(world);
        created += grid.blocks_created;
        removed += grid.blocks_removed;
        if (grid.active_blocks > most) most = grid.active_blocks;
    }
    print("blocks_created", (double)created);
    print("blocks_removed", (double)removed);
    print("most_blocks", (double)most);
}

/* Node by node, from the coordinates of the blocks: every node has a number, and the number leads back to it. */
static void walk(const lahar_world *world) {
    const lahar_grid_statistics grid = grid_of(world);
    const int64_t edge = grid.block_edge;
    int64_t *blocks = integers(DIMENSION * grid.active_blocks);
    int64_t count, node, wrong = 0, with_mass = 0, nodes = 0;
    double mass, sum = 0.0;
    check(lahar_grid_blocks(world, grid.active_blocks, blocks, &count));
    for (int64_t b = 0; b < count; ++b) {
        for (int64_t j = 0; j < edge; ++j) {
            for (int64_t i = 0; i < edge; ++i, ++nodes) {
                const int64_t index[3] = {blocks[2 * b] * edge + i, blocks[2 * b + 1] * edge + j, 0};
                int64_t back[3];
                check(lahar_grid_find_node(world, index, &node));
                if (node < b * edge * edge || node >= (b + 1) * edge * edge) ++wrong; /* not in this block */
                check(lahar_grid_node_index(world, node, back));
                if (back[0] != index[0] || back[1] != index[1] || back[2] != index[2]) ++wrong;
                check(lahar_grid_read(world, "mass", 1, &node, &mass));
                sum += mass;
                if (mass > 0.0) ++with_mass;
            }
        }
    }
    const int64_t far_away[3] = {1000000, -1000000, 0};
    check(lahar_grid_find_node(world, far_away, &node));
    print("nodes_walked", (double)nodes);
    print("nodes_with_mass", (double)with_mass);
    print("wrong_numbers", (double)wrong);
    print("node_far_away", (double)node); /* -1: there is none */
    print("mass_walked", sum);
    free(blocks);
}

/* All nodes at once: mass and momentum of the grid are those of the particles. */
static void add_up(const lahar_world *world, const lahar_totals *particles) {
    const int64_t count = grid_of(world).active_nodes;
    double *mass = doubles(count), *momentum = doubles(DIMENSION * count), sum[3] = {0.0, 0.0, 0.0};
    check(lahar_grid_read(world, "mass", count, NULL, mass));
    check(lahar_grid_read(world, "momentum", count, NULL, momentum));
    for (int64_t i = 0; i < count; ++i) {
        sum[0] += mass[i];
        sum[1] += momentum[2 * i];
        sum[2] += momentum[2 * i + 1];
    }
    print("mass_of_nodes", sum[0]);
    print("mass_of_particles", particles->mass);
    print("momentum_of_nodes_x", sum[1]);
    print("momentum_of_particles_x", particles->momentum[0]);
    print("momentum_of_nodes_y", sum[2]);
    print("momentum_of_particles_y", particles->momentum[1]);
    free(mass);
    free(momentum);
}

/* The names of the node fields with their numbers of components. */
static void list_fields(const lahar_world *world) {
    int64_t count;
    check(lahar_grid_field_count(world, &count));
    print("fields", (double)count);
    for (int64_t f = 0; f < count; ++f) {
        lahar_field_info info;
        info.struct_size = sizeof info;
        check(lahar_grid_field_info(world, f, &info));
        printf("components_of_%s = %d\n", info.name, (int)info.components);
    }
}

int main(int argc, char **argv) {
    const int steps = argc > 1 ? atoi(argv[1]) : 500;
    const double gravity = 9.81, dt = 4e-4, radius = 0.25, thrown[2] = {4.0, 3.0}; /* [m/s^2], [s], [m], [m/s] */
    const char *names[] = {"youngs_modulus", "poissons_ratio"};
    const double values[] = {1e6, 0.3}, center[3] = {-0.5, 0.0, 0.0};
    lahar_context *context;
    lahar_material *rubber;
    lahar_world *world;
    lahar_world_options options;
    lahar_fill fill;
    lahar_totals totals;
    int64_t disc;
    double time;
    check(lahar_context_create(0, &context));
    check(lahar_context_set_log(context, lahar_log_stderr, NULL, LAHAR_LOG_WARNING));
    check(lahar_context_load_plugin(context, "lahar_linear_elastic", NULL));
    check(lahar_material_create(context, "linear_elastic", 2, names, values, &rubber));
    check(lahar_world_options_init(&options, sizeof options));
    options.dimension = DIMENSION;
    options.spacing = 0.05;
    options.gravity[1] = -gravity;
    check(lahar_world_create(context, &options, &world));
    check(lahar_fill_init(&fill, sizeof fill));
    fill.density = 1000.0;
    fill.velocity[0] = thrown[0];
    fill.velocity[1] = thrown[1];
    check(lahar_body_add_sphere(world, rubber, center, radius, &fill, &disc));

    lahar_grid_statistics grid = grid_of(world);
    print("block_edge", (double)grid.block_edge);
    print("start_blocks", (double)grid.active_blocks);
    throw_it(world, steps, dt);
    grid = grid_of(world);
    print("blocks", (double)grid.active_blocks);
    print("nodes", (double)grid.active_nodes);
    print("bytes", (double)grid.bytes);

    totals.struct_size = sizeof totals;
    check(lahar_world_totals(world, disc, &totals));
    check(lahar_world_time(world, &time));
    walk(world);
    add_up(world, &totals);
    list_fields(world);

    /* The velocity in the middle, near the rim, and a metre above, where nothing is. */
    const double *middle = totals.center_of_mass;
    const double points[] = {middle[0], middle[1], middle[0] + 0.9 * radius, middle[1], middle[0], middle[1] + 1.0};
    double velocity[6];
    int32_t inside[3];
    check(lahar_grid_sample(world, "velocity", 3, points, velocity, inside));
    print("time", time);
    print("middle_inside", inside[0]);
    print("middle_velocity_x", velocity[0]);
    print("middle_velocity_y", velocity[1]);
    print("rim_inside", inside[1]);
    print("rim_velocity_x", velocity[2]);
    print("rim_velocity_y", velocity[3]);
    print("above_inside", inside[2]);
    print("above_velocity_x", velocity[4]);
    print("above_velocity_y", velocity[5]);
    print("exact_velocity_x", thrown[0]);
    print("exact_velocity_y", thrown[1] - gravity * time);
    print("speed", hypot(velocity[0], velocity[1]));

    lahar_world_free(world);
    lahar_material_free(rubber);
    lahar_context_free(context);
    return 0;
}
