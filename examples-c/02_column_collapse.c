/* 02_column_collapse: columns of dry sand collapse; how far they run and how high they stay against experiments.
 *
 * A column of width d0 and height h0 = a d0 stands between a smooth wall (x = 0) and a rough floor (y = 0) and is
 * released. Lube, Huppert, Sparks and Freundt (Phys. Rev. E 72, 041301, 2005) found (x - d0)/d0 = 1.2 a for a < 1.8 and
 * 1.9 a^(2/3) for a > 2.8. At rest the height at the wall is h0 if a < 0.7, else about a^(1/3) d0 (Lajeunesse, Monnier, Homsy,
 * Phys. Fluids 17, 103302, 2005).
 *
 * New here: Drucker-Prager sand, particles from arrays with a start stress, walls, a loop with its own time step, fields,
 * files for ParaView. Compile as told in 01_hello.c. Arguments, in any order:
 *   a=...         aspect ratio; may be repeated (default a=0.5 a=1 a=2)
 *   cells=...     cells along d0 (default 40, a multiple of 2)
 *   steps=...     at most so many steps of each column (default: until 5 sqrt(h0/g))
 *   frames=...    a folder that exists, or just its name: gets the last column as six files
 *   transfer=apic instead of FLIP with a little PIC, runs farther
 *   cone=compression   negative control: too strong a cone in plane strain, falls short
 *   friction=0.3       negative control: a floor with this coefficient of friction, runs too far
 */

#include "check.h"
#include <math.h>
#include <string.h>

enum { MAX_CASES = 16, FRAMES = 5 };

typedef struct settings {
    int cases, cells;
    double ratio[MAX_CASES];
    int64_t max_steps;
    const char *frames;
    int apic, compression_cone;
    double floor_friction; /* < 0: the sand sticks */
} settings;

typedef struct column { /* one collapse; SI units */
    double a, d0, h0, h, wave_speed, end_time;
    int64_t count, body;
    double volume0; /* of each particle */
    lahar_material *sand;
    lahar_world *world;
} column;

static const double gravity = 9.81, density = 1600.0, poissons_ratio = 0.3, friction_angle = 30.0;

static settings read_arguments(int argc, char **argv) {
    settings s = {0, 40, {0.5, 1.0, 2.0}, INT64_MAX, NULL, 0, 0, -1.0};
    for (int i = 1; i < argc; ++i) {
        const char *text = argv[i];
        if (strncmp(text, "a=", 2) == 0 && s.cases < MAX_CASES) s.ratio[s.cases++] = atof(text + 2);
        else if (strncmp(text, "cells=", 6) == 0) s.cells = atoi(text + 6);
        else if (strncmp(text, "steps=", 6) == 0) s.max_steps = atoll(text + 6);
        else if (strncmp(text, "frames=", 7) == 0) s.frames = text + 7;
        else if (strncmp(text, "friction=", 9) == 0) s.floor_friction = atof(text + 9);
        else if (strcmp(text, "transfer=apic") == 0) s.apic = 1;
        else if (strcmp(text, "cone=compression") == 0) s.compression_cone = 1;
        else if (strchr(text, '=') == NULL) s.frames = text;
        else {
            fprintf(stderr, "%s: not an argument of this program; its source tells them\n", text);
            exit(2);
        }
    }
    if (s.cases == 0) s.cases = 3;
    return s;
}

/* Sand that is stiff enough: its elastic waves are ten times as fast as a fall from h0 / 2. */
static void make_sand(lahar_context *context, const settings *s, column *c) {
    const double nu = poissons_ratio, modulus = density * c->wave_speed * c->wave_speed;
    const char *names[] = {"youngs_modulus", "poissons_ratio", "friction_angle", "cohesion", "dilation_angle", "cone"};
    const double values[] = {modulus * (1.0 + nu) * (1.0 - 2.0 * nu) / (1.0 - nu), nu, friction_angle, 0.0, 0.0,
                             s->compression_cone ? 0.0 : 2.0 /* plane strain */};
    check(lahar_material_create(context, "drucker_prager", 6, names, values, &c->sand));
}

static void make_world(lahar_context *context, const settings *s, column *c) {
    lahar_world_options options;
    check(lahar_world_options_init(&options, sizeof options));
    options.dimension = 2;
    options.spacing = c->h;
    options.gravity[1] = -gravity;
    options.transfer = s->apic ? LAHAR_TRANSFER_APIC : LAHAR_TRANSFER_PIC_FLIP;
    options.pic_rate = 0.01 * c->wave_speed / (0.35 * c->h);
    check(lahar_world_create(context, &options, &c->world));

    lahar_wall wall;
    check(lahar_wall_init(&wall, sizeof wall));
    wall.axis = 0; /* at x = 0, and then at y = 0 */
    wall.kind = LAHAR_WALL_SLIP;
    check(lahar_wall_add(c->world, &wall, NULL));
    wall.axis = 1;
    wall.kind = s->floor_friction < 0.0 ? LAHAR_WALL_STICKY : LAHAR_WALL_FRICTION;
    wall.friction = s->floor_friction < 0.0 ? 0.0 : s->floor_friction;
    check(lahar_wall_add(c->world, &wall, NULL));
}

/* 2 x 2 particles a cell, with the stress of sand at rest under its own weight. */
static void add_column(const settings *s, column *c) {
    const int64_t columns = 2 * s->cells, rows = (int64_t)(2.0 * s->cells * c->a + 0.5);
    const double pitch = 0.5 * c->h, k0 = poissons_ratio / (1.0 - poissons_ratio);
    c->count = columns * rows;
    c->volume0 = pitch * pitch;
    double *position = doubles(2 * c->count), *volume = doubles(c->count), *stress = doubles(6 * c->count);
    for (int64_t i = 0; i < c->count; ++i) {
        double *sigma = stress + 6 * i;
        position[2 * i] = ((double)(i % columns) + 0.5) * pitch;
        position[2 * i + 1] = ((double)(i / columns) + 0.5) * pitch;
        volume[i] = c->volume0;
        sigma[1] = -density * gravity * (c->h0 - position[2 * i + 1]);
        sigma[0] = sigma[2] = k0 * sigma[1];
        sigma[3] = sigma[4] = sigma[5] = 0.0;
    }
    lahar_particles particles;
    check(lahar_particles_init(&particles, sizeof particles));
    particles.count = c->count;
    particles.density = density;
    particles.position.data = position;
    particles.volume.data = volume;
    particles.stress.data = stress;
    check(lahar_body_add_particles(c->world, c->sand, &particles, &c->body));
    free(position);
    free(volume);
    free(stress);
}

/* Steps until the end; steps are never longer than the first stable one. */
static void collapse(const settings *s, const column *c, int write_frames) {
    const double longest = 0.4 * c->h / (c->wave_speed + sqrt(2.0 * gravity * c->h0));
    double time = 0.0, stable;
    int frame = 0;
    for (int64_t step = 0; step <= s->max_steps; ++step) {
        if (write_frames && time >= frame * c->end_time / FRAMES) {
            char path[1024];
            snprintf(path, sizeof path, "%s/frame_%d.vtp", s->frames, frame);
            check(lahar_world_write_vtp(c->world, path));
            printf("frame_%d_time = %.17g\n", frame++, time);
            fflush(stdout); /* so that who waits sees it */
        }
        if (time >= c->end_time || step == s->max_steps) return;
        check(lahar_world_stable_dt(c->world, &stable));
        check(lahar_world_step(c->world, stable < longest ? stable : longest));
        check(lahar_world_time(c->world, &time));
    }
}

static int compare(const void *left, const void *right) {
    const double a = *(const double *)left, b = *(const double *)right;
    return (a > b) - (a < b);
}

/* Coordinate left of which the share `q` of the particles stands; x is sorted, all masses are equal. */
static double quantile(const double *x, int64_t count, double q) {
    return x[(int64_t)ceil(q * (double)count) - 1];
}

static void print_of(int number, const char *name, double value) {
    char full[64];
    snprintf(full, sizeof full, "case%d_%s", number, name);
    print(full, value);
}

/* What the experiments say: (x - d0)/d0, between the two laws by interpolation. */
static double run_out_of_lube(double a) {
    const double low = 1.2 * 1.8, high = 1.9 * pow(2.8, 2.0 / 3.0);
    if (a <= 1.8) return 1.2 * a;
    if (a >= 2.8) return 1.9 * pow(a, 2.0 / 3.0);
    return low + (high - low) * (a - 1.8);
}

/* Prints what has become of the column. `potential0`: potential energy at the start [J]. */
static void measure(const column *c, int number, double potential0) {
    double *x = doubles(2 * c->count), *volume = doubles(c->count); /* x and y as two columns */
    double near_wall = 0.0, volumes = 0.0;
    check(lahar_body_read(c->world, c->body, "position", c->count, x, c->count, 1));
    check(lahar_body_read(c->world, c->body, "volume", c->count, volume, 0, 0));
    for (int64_t i = 0; i < c->count; ++i) {
        if (x[i] < 2.0 * c->h) near_wall += c->volume0;
        volumes += volume[i];
    }
    qsort(x, (size_t)c->count, sizeof *x, compare);

    lahar_totals totals;
    totals.struct_size = sizeof totals;
    check(lahar_world_totals(c->world, c->body, &totals));
    const double run_out_999 = (quantile(x, c->count, 0.999) - c->d0) / c->d0;
    const double run_out_99 = (quantile(x, c->count, 0.99) - c->d0) / c->d0;
    const double run_out_reference = run_out_of_lube(c->a);
    const double height = near_wall / (2.0 * c->h) / c->d0;
    const double height_reference = c->a < 0.7 ? c->a : pow(c->a, 1.0 / 3.0);
    print_of(number, "run_out_reference", run_out_reference);
    print_of(number, "run_out_999", run_out_999);
    print_of(number, "run_out_999_error", run_out_999 / run_out_reference - 1.0);
    print_of(number, "run_out_99", run_out_99);
    print_of(number, "run_out_99_error", run_out_99 / run_out_reference - 1.0);
    print_of(number, "height_reference", height_reference);
    print_of(number, "height", height);
    print_of(number, "height_error", height / height_reference - 1.0);
    print_of(number, "kinetic_over_start_potential", totals.kinetic_energy / potential0);
    print_of(number, "volume_over_start_volume", volumes / ((double)c->count * c->volume0));
    free(x);
    free(volume);
}

static void run_case(lahar_context *context, const settings *s, int number) {
    column c;
    lahar_totals start;
    int64_t steps;
    double time;
    c.a = s->ratio[number - 1];
    c.d0 = 1.0;
    c.h0 = c.a * c.d0;
    c.h = c.d0 / s->cells;
    c.wave_speed = 10.0 * sqrt(gravity * c.h0);
    c.end_time = 5.0 * sqrt(c.h0 / gravity);
    make_sand(context, s, &c);
    make_world(context, s, &c);
    add_column(s, &c);
    start.struct_size = sizeof start;
    check(lahar_world_totals(c.world, c.body, &start));
    print_of(number, "aspect_ratio", c.a);
    print_of(number, "particles", (double)c.count);

    collapse(s, &c, s->frames != NULL && number == s->cases);
    check(lahar_world_step_count(c.world, &steps));
    check(lahar_world_time(c.world, &time));
    print_of(number, "steps", (double)steps);
    print_of(number, "time", time);
    measure(&c, number, start.potential_energy);
    lahar_world_free(c.world);
    lahar_material_free(c.sand);
}

int main(int argc, char **argv) {
    const settings s = read_arguments(argc, argv);
    lahar_context *context;
    check(lahar_context_create(0, &context));
    check(lahar_context_set_log(context, lahar_log_stderr, NULL, LAHAR_LOG_WARNING));
    check(lahar_context_load_plugin(context, "lahar_drucker_prager", NULL));
    print("cases", s.cases);
    for (int number = 1; number <= s.cases; ++number) run_case(context, &s, number);
    lahar_context_free(context);
    return 0;
}
