/* Checks of the C tests: a failed one is printed and counted; main returns `failures`. */
#ifndef CHECK_H
#define CHECK_H

#include "lahar/lahar.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int failures = 0;

#define CHECK(condition) check(__LINE__, #condition, (condition))

static void check(int line, const char *text, int is_true) {
  if (is_true) return;
  ++failures;
  fprintf(stderr, "line %d: not true: %s\n", line, text);
}

/* The call must answer `wanted`; if that is an error, its message must contain `part` and lahar_last_error_info its code,
 * and the status must be one that the function is documented to return. */
#define EXPECT(call, wanted, part) expect(__LINE__, #call, (call), (wanted), (part))
#define OK(call) EXPECT(call, LAHAR_OK, "")

static void expect(int line, const char *call, lahar_status got, lahar_status wanted, const char *part) {
  char text[2048] = "";
  lahar_error_info info = {0};
  if (got != LAHAR_OK) {
    lahar_last_error_message(text, sizeof text, NULL);
    info.struct_size = sizeof info;
    lahar_last_error_info(&info);
  }
  if (got == wanted && strstr(text, part) && info.code == got && !strstr(text, "not documented for this function")) return;
  ++failures;
  fprintf(stderr, "line %d: %s\n  got %s \"%s\" (code %d)\n  wanted %s with \"%s\"\n", line, call, lahar_status_name(got),
          text, (int)info.code, lahar_status_name(wanted), part);
}

/* What a world shows of itself. Two pictures of an unchanged world are equal byte by byte. */
typedef struct {
  int64_t bodies, steps;
  double time, last_dt, reaction[3];
  lahar_totals totals;
  double position[3][2], velocity[3][2];
} picture;

static picture take_picture(lahar_world *world) {
  picture p;
  double *all;
  int64_t first = 0, n = 0;
  memset(&p, 0, sizeof p);
  lahar_world_body_count(world, &p.bodies);
  lahar_world_step_count(world, &p.steps);
  lahar_world_time(world, &p.time);
  lahar_world_last_dt(world, &p.last_dt);
  lahar_wall_reaction(world, 0, p.reaction);
  p.totals.struct_size = sizeof p.totals;
  lahar_world_totals(world, LAHAR_ALL_BODIES, &p.totals);
  if (lahar_body_particle_count(world, first, &n) == LAHAR_OK && n >= 3 && (all = malloc(2 * (size_t)n * sizeof *all))) {
    if (lahar_body_read(world, first, "position", n, all, 0, 0) == LAHAR_OK) memcpy(p.position, all, sizeof p.position);
    if (lahar_body_read(world, first, "velocity", n, all, 0, 0) == LAHAR_OK) memcpy(p.velocity, all, sizeof p.velocity);
    free(all);
  }
  return p;
}

/* As EXPECT, and the world is what it was. */
#define REFUSED(world, call, wanted, part)                               \
  do {                                                                   \
    picture before = take_picture(world), after;                         \
    EXPECT(call, wanted, part);                                          \
    after = take_picture(world);                                         \
    check(__LINE__, "unchanged after " #call, !memcmp(&before, &after, sizeof before)); \
  } while (0)

/* A context with the plugins whose paths are given, NULL at the end. */
static lahar_context *make_context(const char *const *plugins) {
  lahar_context *context = NULL;
  OK(lahar_context_create(1, &context));
  for (; *plugins; ++plugins) OK(lahar_context_load_plugin(context, *plugins, NULL));
  return context;
}

static lahar_material *make_elastic(lahar_context *context) {
  const char *names[] = {"youngs_modulus", "poissons_ratio"};
  const double values[] = {1e6, 0.3};
  lahar_material *material = NULL;
  OK(lahar_material_create(context, "linear_elastic", 2, names, values, &material));
  return material;
}

/* A plane world with gravity and a floor at y = 0. */
static lahar_world *make_world(lahar_context *context) {
  lahar_world_options options;
  lahar_wall wall;
  lahar_world *world = NULL;
  OK(lahar_world_options_init(&options, sizeof options));
  options.dimension = 2;
  options.spacing = 0.1;
  options.gravity[1] = -9.81;
  OK(lahar_world_create(context, &options, &world));
  OK(lahar_wall_init(&wall, sizeof wall));
  wall.axis = 1;
  OK(lahar_wall_add(world, &wall, NULL));
  return world;
}

/* A block of 1 m x 1 m on the floor. */
static int64_t add_block(lahar_world *world, const lahar_material *material, double density) {
  const double min[3] = {0, 0, 0}, max[3] = {1, 1, 0};
  lahar_fill fill;
  int64_t body = -1;
  OK(lahar_fill_init(&fill, sizeof fill));
  fill.density = density;
  OK(lahar_body_add_box(world, material, min, max, &fill, &body));
  return body;
}

#endif
