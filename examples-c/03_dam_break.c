/* 03_dam_break: a column of water collapses; its front and its height against an experiment.
 *
 * Martin and Moyce (Phil. Trans. R. Soc. Lond. A 244, 312, 1952) let water of width a and height H = 2 a run over a dry
 * floor and noted when the front, Z = x / a, and the height at the wall, y / H, passed marks. The dimensionless times are
 * T = t sqrt(2 g / a) for the front and tau = t sqrt(g / a) for the height. The experiment's clock starts late: the gate opens
 * in a finite time, so the front is compared as it is and after one shift of time.
 *
 * The wall is a plane of symmetry: the water is computed with its mirror image and runs to both sides. Water has no
 * tensile strength: with it (zero_tension = 0) the thin tip hangs together, tears, and its speed hangs on details of the grid.
 *
 * New here: a fluid, a start in equilibrium, views to look at the particles in each step. Compile as told in 01_hello.c,
 * run from the folder of the repository. Arguments, in any order:
 *   cells=...     cells along the height (default 40, a multiple of 2)
 *   points=...    particles per cell along each axis (default 2)
 *   steps=...     at most so many steps (default: until T = 3.83, half a unit after the last mark of the front)
 *   frames=...    a folder that exists: gets six files for ParaView
 *   table=...     the experiment (default tests/data/martin_moyce_1952.csv)
 *   viscosity=... [Pa s] (default 1e-3); 5, as of honey, is a negative control: the front lags behind
 */

#include "check.h"
#include <math.h>
#include <string.h>

enum { MAX_MARKS = 64, FRAMES = 5 };

static const double gravity = 9.81, density = 1000.0, width = 0.05715; /* SI units */
static const double first_front = 0.84, last_front = 3.33, first_slope = 1.83, end_time = 3.83; /* [T] */

typedef struct settings {
    int cells, points;
    double viscosity;
    int64_t max_steps;
    const char *frames, *table;
} settings;

typedef struct marks { /* the experiment: times and values */
    int count;
    double time[MAX_MARKS], value[MAX_MARKS];
} marks;

typedef struct series { /* the computation, step by step */
    int64_t count, capacity;
    double *time, *front, *height; /* [s], x / a, y / H */
    double worst_volume, most_void; /* largest |V / V0 - 1| up to the last mark of the front, largest share of voids in it */
} series;

static settings read_arguments(int argc, char **argv) {
    settings s = {40, 2, 1e-3, INT64_MAX, NULL, "tests/data/martin_moyce_1952.csv"};
    for (int i = 1; i < argc; ++i) {
        const char *text = argv[i];
        if (strncmp(text, "cells=", 6) == 0) s.cells = atoi(text + 6);
        else if (strncmp(text, "points=", 7) == 0) s.points = atoi(text + 7);
        else if (strncmp(text, "viscosity=", 10) == 0) s.viscosity = atof(text + 10);
        else if (strncmp(text, "steps=", 6) == 0) s.max_steps = atoll(text + 6);
        else if (strncmp(text, "frames=", 7) == 0) s.frames = text + 7;
        else if (strncmp(text, "table=", 6) == 0) s.table = text + 6;
        else {
            fprintf(stderr, "%s: not an argument of this program; its source tells them\n", text);
            exit(2);
        }
    }
    return s;
}

/* The lines "front,T,Z" and "height,tau,y/H" of the table. */
static void read_table(const char *path, marks *front, marks *height) {
    char line[256], kind[16];
    double time, value;
    FILE *file = fopen(path, "r");
    if (file == NULL) {
        fprintf(stderr, "%s: cannot be read; run from the folder of the repository or give table=...\n", path);
        exit(2);
    }
    front->count = height->count = 0;
    while (fgets(line, sizeof line, file) != NULL) {
        if (sscanf(line, "%15[a-z],%lf,%lf", kind, &time, &value) != 3) continue;
        marks *m = strcmp(kind, "front") == 0 ? front : height;
        if (m->count == MAX_MARKS) break;
        m->time[m->count] = time;
        m->value[m->count++] = value;
    }
    fclose(file);
}

/* Water that is stiff enough: its sound is ten times as fast as a fall from H. */
static double sound_speed(void) { return 10.0 * sqrt(2.0 * gravity * 2.0 * width); }

/* The floor lets the water slide. */
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
    wall.kind = LAHAR_WALL_SLIP;
    wall.axis = 1;
    check(lahar_wall_add(world, &wall, NULL));
    return world;
}

/* Water and its mirror image at rest: the pressure is that of the depth, and compresses the water. */
static int64_t add_water(const settings *s, lahar_world *world, const lahar_material *water, double h) {
    const int64_t rows = (int64_t)s->cells * s->points, columns = rows;
    const double pitch = h / s->points, bulk = density * sound_speed() * sound_speed();
    lahar_particles particles;
    int64_t body;
    check(lahar_particles_init(&particles, sizeof particles));
    particles.count = rows * columns;
    double *position = doubles(2 * particles.count), *volume = doubles(particles.count);
    double *mass = doubles(particles.count), *stress = doubles(6 * particles.count);
    for (int64_t i = 0; i < particles.count; ++i) {
        double *x = position + 2 * i, *sigma = stress + 6 * i;
        x[0] = ((double)(i % columns) + 0.5) * pitch - width;
        x[1] = ((double)(i / columns) + 0.5) * pitch;
        const double pressure = density * gravity * (2.0 * width - x[1]);
        mass[i] = density * pitch * pitch;
        volume[i] = pitch * pitch / (1.0 + pressure / bulk);
        sigma[0] = sigma[1] = sigma[2] = -pressure;
        sigma[3] = sigma[4] = sigma[5] = 0.0;
    }
    particles.position.data = position;
    particles.volume.data = volume;
    particles.mass.data = mass;
    particles.stress.data = stress;
    check(lahar_body_add_particles(world, water, &particles, &body));
    free(position);
    free(volume);
    free(mass);
    free(stress);
    return body;
}

/* Notes the time, the front and the height at the wall: the volume nearer to it than a / 5, over this width. Where water has
 * been pulled apart its volume ratio J, which counts on, exceeds 1: the volume holds a void, which is no water. */
static void note(lahar_world *world, int64_t body, double start_volume, series *r) {
    enum { X, VOLUME, RATIO, FIELDS };
    const char *names[FIELDS] = {"position", "volume", "volume_ratio"};
    lahar_view *views[FIELDS];
    lahar_view_info of[FIELDS];
    double front = 0.0, near_wall = 0.0, water = 0.0, voids = 0.0;
    if (r->count == r->capacity) {
        fprintf(stderr, "more steps than expected\n");
        exit(1);
    }
    for (int f = 0; f < FIELDS; ++f) {
        of[f].struct_size = sizeof of[f];
        check(lahar_body_view(world, body, names[f], LAHAR_ACCESS_READ, &views[f]));
        check(lahar_view_data(views[f], &of[f]));
    }
    for (int64_t k = 0; k < of[X].count; ++k) { /* x is the first component of the position */
        const double x = of[X].data[k], volume = of[VOLUME].data[k] / fmax(of[RATIO].data[k], 1.0);
        if (x > front) front = x;
        if (fabs(x) < 0.2 * width) near_wall += 0.5 * volume;
        water += volume;
        voids += of[VOLUME].data[k] - volume;
    }
    for (int f = 0; f < FIELDS; ++f) lahar_view_free(views[f]);
    check(lahar_world_time(world, &r->time[r->count]));
    r->front[r->count] = front / width;
    r->height[r->count] = near_wall / (0.2 * width) / (2.0 * width);
    if (r->time[r->count] <= last_front * sqrt(width / (2.0 * gravity))) {
        r->worst_volume = fmax(r->worst_volume, fabs((water + voids) / start_volume - 1.0));
        r->most_void = fmax(r->most_void, voids / start_volume);
    }
    ++r->count;
}

static double sum_of(const lahar_world *world, int64_t body, const char *field) {
    int64_t count;
    double sum = 0.0;
    check(lahar_body_particle_count(world, body, &count));
    double *values = doubles(count);
    check(lahar_body_read(world, body, field, count, values, 0, 0));
    for (int64_t k = 0; k < count; ++k) sum += values[k];
    free(values);
    return sum;
}

/* Steps of the stable length until `end` [s]. */
static void collapse(const settings *s, lahar_world *world, int64_t body, double end, series *r) {
    const double start_volume = sum_of(world, body, "volume");
    int frame = 0;
    note(world, body, start_volume, r);
    for (int64_t step = 0;; ++step) {
        const double time = r->time[r->count - 1];
        if (s->frames != NULL && time >= frame * end / FRAMES) {
            char path[1024];
            snprintf(path, sizeof path, "%s/frame_%d.vtp", s->frames, frame++);
            check(lahar_world_write_vtp(world, path));
        }
        if (time >= end || step == s->max_steps) return;
        check(lahar_world_advance(world, end, 1, NULL, NULL));
        note(world, body, start_volume, r);
    }
}

/* Value at a time between two steps; the last one after the end. */
static double at(const series *r, const double *values, double time) {
    int64_t low = 0, high = r->count - 1;
    if (time <= r->time[0]) return values[0];
    if (time >= r->time[high]) return values[high];
    while (high - low > 1) {
        const int64_t middle = (low + high) / 2;
        if (r->time[middle] <= time) low = middle;
        else high = middle;
    }
    return values[low] + (values[high] - values[low]) * (time - r->time[low]) / (r->time[high] - r->time[low]);
}

/* Root mean square of the front's error, with the experiment's clock put back by `shift`; relative or not. */
static double front_error(const series *r, const marks *m, double shift, int relative) {
    double sum = 0.0;
    int count = 0;
    for (int i = 0; i < m->count; ++i) {
        if (m->time[i] < first_front || m->time[i] > last_front) continue;
        const double z = at(r, r->front, (m->time[i] - shift) / sqrt(2.0 * gravity / width));
        const double error = (z - m->value[i]) / (relative ? m->value[i] : 1.0);
        sum += error * error;
        ++count;
    }
    return sqrt(sum / count);
}

static void judge(const series *r, const marks *front, const marks *height) {
    double best_shift = 0.0, best = front_error(r, front, 0.0, 0), worst_height = 0.0;
    double n = 0.0, st = 0.0, sz = 0.0, stt = 0.0, stz = 0.0;
    for (int i = -500; i <= 500; ++i) {
        const double shift = 0.001 * i, error = front_error(r, front, shift, 0);
        if (error < best) {
            best = error;
            best_shift = shift;
        }
    }
    for (int i = 0; i < front->count; ++i) { /* the slope of a line through the marks in the steady part */
        const double t = front->time[i], z = at(r, r->front, t / sqrt(2.0 * gravity / width));
        if (t < first_slope || t > last_front) continue;
        n += 1.0;
        st += t;
        sz += z;
        stt += t * t;
        stz += t * z;
    }
    for (int i = 0; i < height->count; ++i) {
        const double y = at(r, r->height, height->time[i] / sqrt(gravity / width));
        if (height->time[i] > end_time / sqrt(2.0)) continue;
        worst_height = fmax(worst_height, fabs(y - height->value[i]));
    }
    print("front_relative_rms", front_error(r, front, 0.0, 1));
    print("front_shift", best_shift);
    print("front_rms_after_shift", best);
    print("front_slope", (n * stz - st * sz) / (n * stt - st * st));
    print("height_worst_error", worst_height);
    print("volume_worst_drift", r->worst_volume);
    print("void_largest_share", r->most_void);
}

int main(int argc, char **argv) {
    const settings s = read_arguments(argc, argv);
    const double h = 2.0 * width / s.cells;
    const char *names[] = {"bulk_modulus", "viscosity", "equation_of_state", "zero_tension"};
    const double values[] = {density * sound_speed() * sound_speed(), s.viscosity, 1.0 /* p = K (V0/V - 1) */, 1.0 /* yes */};
    marks front, height;
    lahar_context *context;
    lahar_material *water;
    lahar_world *world;
    read_table(s.table, &front, &height);
    check(lahar_context_create(0, &context));
    check(lahar_context_set_log(context, lahar_log_stderr, NULL, LAHAR_LOG_WARNING));
    check(lahar_context_load_plugin(context, "lahar_newtonian", NULL));
    check(lahar_material_create(context, "newtonian", 4, names, values, &water));
    world = make_world(context, h);
    const int64_t body = add_water(&s, world, water, h);

    const double end = end_time / sqrt(2.0 * gravity / width);
    series r = {0, 100000, doubles(100000), doubles(100000), doubles(100000), 0.0, 0.0};
    collapse(&s, world, body, end, &r);
    print("particles", (double)s.cells * s.points * s.cells * s.points);
    print("steps", (double)(r.count - 1));
    print("time", r.time[r.count - 1]);
    print("front", r.front[r.count - 1]);
    print("height", r.height[r.count - 1]);
    judge(&r, &front, &height);

    free(r.time);
    free(r.front);
    free(r.height);
    lahar_world_free(world);
    lahar_material_free(water);
    lahar_context_free(context);
    return 0;
}
