/* 05_host_arrays: a bank of soil that lives in the arrays of the host.
 *
 * The host has the particles already, from a geostatic analysis of its own: positions, volumes and stresses. Under these
 * stresses the bank rests between its walls. Then the host digs: it takes the right wall away, the bank slides, and the
 * host reads stresses and plastic strain back, stops the slide through a view, and forgets the plastic strain.
 *
 * New here: arrays in different layouts, fields and state variables by name, reading and writing by id, views in storage
 * order, removal of a wall. Compile as told in 01_hello.c. Arguments: cells along the height (10 if not given), and steps
 * of each of the two parts (300 if not given).
 */

#include "check.h"

static const double height = 1.0, width = 1.0, gravity = 9.81, density = 2000.0; /* SI units */
static const double youngs_modulus = 1e7, poissons_ratio = 0.35; /* with 0.3 this soil would yield already at rest */

/* What the host knows. Particle k has the position x[2 k], x[2 k + 1], interleaved; the velocities are two columns, first
 * all x, then all y; the stresses are interleaved, xx, yy, zz, xy, yz, zx. */
typedef struct host {
    int64_t count;
    double *x, *velocity, *volume, *stress;
} host;

static host geostatic(int cells) {
    const int64_t columns = 2 * cells; /* 2 x 2 particles a cell */
    const double pitch = 0.5 * height / cells, k0 = poissons_ratio / (1.0 - poissons_ratio);
    host h;
    h.count = columns * columns;
    h.x = doubles(2 * h.count);
    h.velocity = doubles(2 * h.count);
    h.volume = doubles(h.count);
    h.stress = doubles(6 * h.count);
    for (int64_t k = 0; k < h.count; ++k) {
        double *sigma = h.stress + 6 * k;
        h.x[2 * k] = ((double)(k % columns) + 0.5) * pitch;
        h.x[2 * k + 1] = ((double)(k / columns) + 0.5) * pitch;
        h.velocity[k] = h.velocity[h.count + k] = 0.0;
        h.volume[k] = pitch * pitch;
        sigma[1] = -density * gravity * (height - h.x[2 * k + 1]);
        sigma[0] = sigma[2] = k0 * sigma[1];
        sigma[3] = sigma[4] = sigma[5] = 0.0;
    }
    return h;
}

/* Slip walls left, right and below. */
static void make_world(lahar_context *context, int cells, lahar_world **world, int64_t *right) {
    lahar_world_options options;
    lahar_wall wall;
    check(lahar_world_options_init(&options, sizeof options));
    options.dimension = 2;
    options.spacing = height / cells;
    options.gravity[1] = -gravity;
    check(lahar_world_create(context, &options, world));
    check(lahar_wall_init(&wall, sizeof wall));
    wall.kind = LAHAR_WALL_SLIP;
    wall.axis = 0;
    check(lahar_wall_add(*world, &wall, NULL));
    wall.axis = 1;
    check(lahar_wall_add(*world, &wall, NULL));
    wall.axis = 0;
    wall.side = -1;
    wall.position = width;
    check(lahar_wall_add(*world, &wall, right));
}

/* Both strides 0 say "interleaved"; the columns of the velocity are `count` doubles apart. */
static int64_t add_bank(lahar_world *world, const lahar_material *soil, const host *h) {
    lahar_particles particles;
    int64_t body;
    check(lahar_particles_init(&particles, sizeof particles));
    particles.count = h->count;
    particles.density = density;
    particles.position.data = h->x;
    particles.velocity.data = h->velocity;
    particles.velocity.component_stride = h->count;
    particles.velocity.point_stride = 1;
    particles.volume.data = h->volume;
    particles.stress.data = h->stress;
    check(lahar_body_add_particles(world, soil, &particles, &body));
    return body;
}

static void steps_of(lahar_world *world, int steps) {
    for (int step = 0; step < steps; ++step) check(lahar_world_step_auto(world, NULL));
}

static double largest(const double *values, int64_t count) {
    double found = values[0];
    for (int64_t k = 1; k < count; ++k) found = values[k] > found ? values[k] : found;
    return found;
}

/* Reads stresses as columns, although they came interleaved, and compares them with the start. */
static void rest(const lahar_world *world, int64_t body, const host *h) {
    double *stress = doubles(6 * h->count), worst = 0.0;
    check(lahar_body_read(world, body, "stress", h->count, stress, h->count, 1));
    for (int64_t k = 0; k < h->count; ++k) {
        for (int c = 0; c < 6; ++c) {
            const double change = stress[c * h->count + k] - h->stress[6 * k + c];
            if (change > worst) worst = change;
            if (-change > worst) worst = -change;
        }
    }
    print("rest_stress_yy_of_particle_0", stress[h->count]);
    print("rest_stress_change_over_base_stress", worst / (density * gravity * height));
    free(stress);
}

/* The memory itself, without a copy. Its order is that of storage; lahar_body_ids tells whose value is whose. */
static void look(lahar_world *world, int64_t body, const host *h) {
    lahar_view *view;
    lahar_view_info info;
    int64_t *ids = (int64_t *)malloc((size_t)h->count * sizeof(int64_t)), count, wrong = 0;
    double *by_id = doubles(h->count), toe;
    if (ids == NULL) exit(1);
    check(lahar_body_ids(world, body, h->count, ids, &count));
    check(lahar_body_read(world, body, "equivalent_plastic_strain", h->count, by_id, 0, 0));
    check(lahar_body_view(world, body, "equivalent_plastic_strain", LAHAR_ACCESS_READ, &view));
    info.struct_size = sizeof info;
    check(lahar_view_data(view, &info));
    for (int64_t k = 0; k < info.count; ++k)
        if (info.data[k] != by_id[ids[k]]) ++wrong;
    print("slide_largest_plastic_strain", largest(info.data, info.count));
    print("view_differs_from_copy", (double)wrong);
    lahar_view_free(view);

    check(lahar_body_view(world, body, "position", LAHAR_ACCESS_READ, &view));
    check(lahar_view_data(view, &info));
    toe = largest(info.data, info.count); /* x stands first, y from data[stride] on */
    print("slide_toe_x", toe);
    print("slide_top_y", largest(info.data + info.stride, info.count));
    lahar_view_free(view);
    free(ids);
    free(by_id);
}

/* Stops the bank through a view that writes; while it is open the world does not step. */
static void stop(lahar_world *world, int64_t body) {
    lahar_view *view;
    lahar_view_info info;
    check(lahar_body_view(world, body, "velocity", LAHAR_ACCESS_WRITE, &view));
    info.struct_size = sizeof info;
    check(lahar_view_data(view, &info));
    for (int c = 0; c < info.components; ++c)
        for (int64_t k = 0; k < info.count; ++k) info.data[c * info.stride + k] = 0.0;
    print("step_with_open_view_is_refused", lahar_world_step_auto(world, NULL) == LAHAR_ERROR_VIEW_OPEN);
    lahar_view_free(view);
}

/* Writes a state variable of the model by its name, in the order of the ids. */
static void forget(lahar_world *world, int64_t body, int64_t count) {
    double *strain = doubles(count);
    for (int64_t k = 0; k < count; ++k) strain[k] = 0.0;
    check(lahar_body_write(world, body, "equivalent_plastic_strain", count, strain, 0, 0));
    check(lahar_body_read(world, body, "equivalent_plastic_strain", count, strain, 0, 0));
    print("forgotten_largest_plastic_strain", largest(strain, count));
    free(strain);
}

static lahar_totals totals_of(const lahar_world *world, int64_t body) {
    lahar_totals totals;
    totals.struct_size = sizeof totals;
    check(lahar_world_totals(world, body, &totals));
    return totals;
}

int main(int argc, char **argv) {
    const int cells = argc > 1 ? atoi(argv[1]) : 10, steps = argc > 2 ? atoi(argv[2]) : 300;
    const char *names[] = {"youngs_modulus", "poissons_ratio", "friction_angle", "cohesion", "cone"};
    const double values[] = {youngs_modulus, poissons_ratio, 30.0, 0.0, 2.0 /* plane strain */};
    lahar_context *context;
    lahar_material *soil;
    lahar_world *world;
    int64_t body, right;
    double force[3];
    check(lahar_context_create(0, &context));
    check(lahar_context_set_log(context, lahar_log_stderr, NULL, LAHAR_LOG_WARNING));
    check(lahar_context_load_plugin(context, "lahar_drucker_prager", NULL));
    check(lahar_material_create(context, "drucker_prager", 5, names, values, &soil));
    host h = geostatic(cells);
    make_world(context, cells, &world, &right);
    body = add_bank(world, soil, &h);
    lahar_totals totals = totals_of(world, body);
    print("particles", (double)totals.particles);
    print("mass", totals.mass);
    print("start_center_y", totals.center_of_mass[1]);

    steps_of(world, steps);
    rest(world, body, &h);
    check(lahar_wall_reaction(world, right, force));
    totals = totals_of(world, body);
    print("rest_kinetic_over_potential", totals.kinetic_energy / totals.potential_energy);
    print("rest_force_of_right_wall", force[0]);
    print("earth_pressure_at_rest", -0.5 * poissons_ratio / (1.0 - poissons_ratio) * density * gravity * height * height);

    check(lahar_wall_remove(world, right));
    steps_of(world, steps);
    look(world, body, &h);
    totals = totals_of(world, body);
    print("slide_momentum_x", totals.momentum[0]);
    print("slide_center_y", totals.center_of_mass[1]);
    stop(world, body);
    forget(world, body, h.count);
    totals = totals_of(world, body);
    print("stopped_kinetic_energy", totals.kinetic_energy);
    steps_of(world, 1);
    print("slides_again", totals_of(world, body).momentum[0] > 0.0);

    lahar_world_free(world);
    lahar_material_free(soil);
    lahar_context_free(context);
    free(h.x);
    free(h.velocity);
    free(h.volume);
    free(h.stress);
    return 0;
}
