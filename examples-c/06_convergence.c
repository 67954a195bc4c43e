/* 06_convergence: how fast errors fall as cells shrink, for three shape functions.
 *
 * A motion is chosen, u = A sin(pi X) sin(pi c t) with c = sqrt(E / rho) between slip walls at X = 0 and X = 1, and the body
 * force that makes a neo-Hookean body move like that (P. C. Wallstedt, J. E. Guilkey, J. Comput. Phys. 227 (2008)
 * 9628-9642). The host writes it for each particle before each step. Order 2 is what the method can reach. With A = 0.05
 * particles cross cells: GIMP and cubic splines keep the order, linear shapes diverge.
 *
 * New here: body forces, walls on node planes next to modified splines, the deformation of GIMP domains, steps of a given
 * length. Compile as told in 01_hello.c. Arguments: cells of the coarsest grid (16 if not given), number of grids, each
 * twice as fine as the one before (3 if not given, at least 2), and A (0.05 if not given).
 */

#include "check.h"
#include <math.h>

static const double pi = 3.14159265358979323846;
static const double youngs_modulus = 1e4, poissons_ratio = 0.3, density = 1.0; /* SI units; the length is 1 m */

typedef struct constants {
    double lambda, mu, bar_speed, wave_speed;
} constants;

typedef struct kernel {
    const char *name;
    int32_t shape;
} kernel;

static constants constants_of(void) {
    constants k;
    k.lambda = youngs_modulus * poissons_ratio / ((1.0 + poissons_ratio) * (1.0 - 2.0 * poissons_ratio));
    k.mu = youngs_modulus / (2.0 * (1.0 + poissons_ratio));
    k.bar_speed = sqrt(youngs_modulus / density);
    k.wave_speed = sqrt((k.lambda + 2.0 * k.mu) / density);
    return k;
}

/* The force per mass for the particle that rests at X, where `swing` is A sin(pi c t). */
static double force_of(const constants *k, double X, double swing) {
    const double u = swing * sin(pi * X), f = 1.0 + pi * swing * cos(pi * X);
    const double elastic = k->lambda * (1.0 - log(f)) / (f * f) + k->mu * (1.0 + 1.0 / (f * f));
    return pi * pi * u / density * (elastic - youngs_modulus);
}

/* One row of cells between four slip walls on node planes. The shape functions end there. */
static lahar_world *make_world(lahar_context *context, int32_t shape, double h) {
    lahar_world_options options;
    lahar_wall wall;
    lahar_world *world;
    check(lahar_world_options_init(&options, sizeof options));
    options.dimension = 2;
    options.spacing = h;
    options.shape = shape;
    options.transfer = LAHAR_TRANSFER_PIC_FLIP;
    options.order = LAHAR_ORDER_USL;
    options.wall_treatment = LAHAR_WALLS_MODIFIED;
    options.body_force = 1;
    options.cfl = 1.0; /* the steps are given, and shorter */
    check(lahar_world_create(context, &options, &world));
    check(lahar_wall_init(&wall, sizeof wall));
    wall.kind = LAHAR_WALL_SLIP;
    for (int32_t axis = 0; axis < 2; ++axis) {
        wall.axis = axis;
        wall.side = 1;
        wall.position = 0.0;
        check(lahar_wall_add(world, &wall, NULL));
        wall.side = -1;
        wall.position = axis == 0 ? 1.0 : h;
        check(lahar_wall_add(world, &wall, NULL));
    }
    return world;
}

/* The L2 norm of the error of the displacement over A, at t = 0.75 / c. */
static double error_of(lahar_context *context, const lahar_material *rubber, int32_t shape, int cells, double A) {
    const constants k = constants_of();
    const double h = 1.0 / cells, end = 0.75 / k.bar_speed;
    const int steps = (int)ceil(end * (k.wave_speed + pi * A * k.bar_speed) / (0.1 * h));
    const double dt = end / steps, low[3] = {0.0, 0.0, 0.0}, high[3] = {1.0, h, 0.0};
    lahar_world *world = make_world(context, shape, h);
    lahar_fill fill;
    int64_t body, n;
    check(lahar_fill_init(&fill, sizeof fill));
    fill.density = density;
    fill.particles_per_cell = 2;
    check(lahar_body_add_box(world, rubber, low, high, &fill, &body));
    check(lahar_body_particle_count(world, body, &n));
    double *rest = doubles(2 * n), *x = doubles(2 * n), *vector = doubles(2 * n);
    check(lahar_body_read(world, body, "position", n, rest, 0, 0));

    /* Velocities half a step before the start make the steps those of the leapfrog scheme, of second order in time. */
    for (int64_t p = 0; p < n; ++p) {
        vector[2 * p] = pi * k.bar_speed * A * sin(pi * rest[2 * p]) * cos(0.5 * pi * k.bar_speed * dt);
        vector[2 * p + 1] = 0.0;
    }
    check(lahar_body_write(world, body, "velocity", n, vector, 0, 0));
    for (int step = 0; step < steps; ++step) {
        const double swing = A * sin(pi * k.bar_speed * (step * dt));
        for (int64_t p = 0; p < n; ++p) vector[2 * p] = force_of(&k, rest[2 * p], swing);
        check(lahar_body_write(world, body, "body_force", n, vector, 0, 0));
        check(lahar_world_step(world, dt));
    }

    double sum = 0.0;
    const double swing = A * sin(pi * k.bar_speed * end);
    check(lahar_body_read(world, body, "position", n, x, 0, 0));
    for (int64_t p = 0; p < n; ++p) {
        const double away = x[2 * p] - rest[2 * p] - swing * sin(pi * rest[2 * p]);
        sum += away * away;
    }
    free(rest);
    free(x);
    free(vector);
    lahar_world_free(world);
    return sqrt(sum / (double)n) / A;
}

int main(int argc, char **argv) {
    static const kernel kernels[] = {{"linear", LAHAR_SHAPE_LINEAR},
                                     {"contiguous_gimp", LAHAR_SHAPE_CONTIGUOUS_GIMP},
                                     {"cubic", LAHAR_SHAPE_CUBIC_BSPLINE}};
    const int coarsest = argc > 1 ? atoi(argv[1]) : 16, grids = argc > 2 ? atoi(argv[2]) : 3;
    const double A = argc > 3 ? atof(argv[3]) : 0.05;
    if (coarsest < 1 || grids < 2 || !(A > 0.0)) {
        fprintf(stderr, "usage: 06_convergence [cells >= 1, default 16] [grids >= 2, default 3] [amplitude > 0, default 0.05 m]\n");
        return 2;
    }
    const char *names[] = {"youngs_modulus", "poissons_ratio"};
    const double values[] = {youngs_modulus, poissons_ratio};
    lahar_context *context;
    lahar_material *rubber;
    check(lahar_context_create(0, &context));
    check(lahar_context_set_log(context, lahar_log_stderr, NULL, LAHAR_LOG_WARNING));
    check(lahar_context_load_plugin(context, "lahar_neo_hookean", NULL));
    check(lahar_material_create(context, "neo_hookean", 2, names, values, &rubber));
    for (int k = 0; k < 3; ++k) {
        char name[64];
        double first = 0.0, error = 0.0;
        for (int grid = 0, cells = coarsest; grid < grids; ++grid, cells *= 2) {
            error = error_of(context, rubber, kernels[k].shape, cells, A);
            if (grid == 0) first = error;
            sprintf(name, "%s_error_%d", kernels[k].name, cells);
            print(name, error);
        }
        sprintf(name, "%s_order", kernels[k].name);
        print(name, log(first / error) / log(2.0) / (grids - 1));
    }
    lahar_material_free(rubber);
    lahar_context_free(context);
    return 0;
}
