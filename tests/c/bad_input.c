/* Bad input, one function a line of the list: each call gets a status and a message that says what was expected, and the
 * world is what it was. Arguments: the elastic plugin, nan_model, failing_model, wrong_major, a file that is no plugin. */
#include "check.h"

#include <pthread.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

static lahar_context *context;
static lahar_material *material;
static lahar_world *world;

static void wrong_struct_size(void) {
  struct {
    lahar_world_options options;
    double newer;
  } grown;
  struct {
    lahar_totals totals;
    double newer;
  } result;
  lahar_wall wall;
  lahar_fill fill;
  lahar_particles particles;
  const double min[3] = {0, 0, 0}, max[3] = {1, 1, 0};
  lahar_world *made = world;
  int64_t id;
  OK(lahar_wall_init(&wall, sizeof wall));
  wall.struct_size = 0;
  REFUSED(world, lahar_wall_add(world, &wall, &id), LAHAR_ERROR_STRUCT_SIZE, "struct_size of lahar_wall is 0; expected");
  wall.struct_size = sizeof wall - 8;
  REFUSED(world, lahar_wall_add(world, &wall, &id), LAHAR_ERROR_STRUCT_SIZE, "is 24; expected sizeof(lahar_wall), which is 32");
  wall.struct_size = 0xffffffffu;
  REFUSED(world, lahar_wall_add(world, &wall, &id), LAHAR_ERROR_STRUCT_SIZE, "is 4294967295; expected");
  OK(lahar_fill_init(&fill, sizeof fill));
  fill.struct_size = 4;
  REFUSED(world, lahar_body_add_box(world, material, min, max, &fill, &id), LAHAR_ERROR_STRUCT_SIZE, "lahar_fill is 4");
  OK(lahar_particles_init(&particles, sizeof particles));
  particles.struct_size = 8;
  REFUSED(world, lahar_body_add_particles(world, material, &particles, &id), LAHAR_ERROR_STRUCT_SIZE, "lahar_particles is 8");
  EXPECT(lahar_wall_init(&wall, -1), LAHAR_ERROR_STRUCT_SIZE, "is -1; expected");

  /* A host that knows more than the library: accepted while it does not use the new field. */
  OK(lahar_world_options_init(&grown.options, sizeof grown));
  CHECK(grown.options.struct_size == sizeof grown && grown.newer == 0);
  grown.options.spacing = 0.1;
  OK(lahar_world_create(context, &grown.options, &made));
  lahar_world_free(made);
  grown.newer = 1;
  made = world;
  EXPECT(lahar_world_create(context, &grown.options, &made), LAHAR_ERROR_STRUCT_SIZE, "the rest is not zero");
  CHECK(made == NULL);

  result.newer = 7;
  result.totals.struct_size = 0;
  REFUSED(world, lahar_world_totals(world, LAHAR_ALL_BODIES, &result.totals), LAHAR_ERROR_STRUCT_SIZE, "lahar_totals is 0");
  result.totals.struct_size = sizeof result;
  OK(lahar_world_totals(world, LAHAR_ALL_BODIES, &result.totals));
  CHECK(result.newer == 0 && result.totals.struct_size == sizeof result && result.totals.particles > 0);
}

static void bad_texts(void) {
  char text[5000];
  int64_t index;
  memset(text, 'x', sizeof text);
  text[sizeof text - 1] = 0;
  EXPECT(lahar_context_find_model(context, "a\nb\x1b[31m", &index), LAHAR_ERROR_UNKNOWN_NAME, "`a\\nb\\u{1b}[31m`");
  EXPECT(lahar_context_find_model(context, "a\xff", &index), LAHAR_ERROR_INVALID_ARGUMENT, "is not UTF-8 after `a`");
  EXPECT(lahar_context_find_model(context, text, &index), LAHAR_ERROR_INVALID_ARGUMENT, "has 4999 bytes; expected 4096");
}

static void static_grid_larger_than_memory(void) {
  lahar_world_options options;
  lahar_world *made = world;
  time_t start = time(NULL);
  OK(lahar_world_options_init(&options, sizeof options));
  options.spacing = 1;
  options.grid_policy = LAHAR_GRID_STATIC;
  options.box_max[0] = options.box_max[1] = options.box_max[2] = 1800; /* 9e7 blocks of 6 kB */
  EXPECT(lahar_world_create(context, &options, &made), LAHAR_ERROR_OUT_OF_MEMORY, "the blocks of a static grid");
  CHECK(made == NULL && difftime(time(NULL), start) < 5);
}

static void stable_step_of_no_particles(void) {
  lahar_world *empty = make_world(context); /* with gravity */
  double stable = 0;
  OK(lahar_world_stable_dt(empty, &stable));
  CHECK(isinf(stable) && stable > 0);
  EXPECT(lahar_world_step_auto(empty, NULL), LAHAR_ERROR_INVALID_ARGUMENT, "the stable step is infinite");
  lahar_world_free(empty);
}

/* Adds three particles of which one value is bad. */
static void refuse_particle(double bad, int which, const char *part) {
  double position[6] = {0.1, 0.1, 0.2, 0.2, 0.3, 0.3}, volume[3] = {1e-3, 1e-3, 1e-3}, mass[3] = {1, 1, 1};
  double velocity[6] = {0}, stress[18] = {0};
  double *const first[] = {position, volume, mass, velocity, stress};
  lahar_particles particles;
  int64_t body = 77;
  first[which][1] = bad;
  OK(lahar_particles_init(&particles, sizeof particles));
  particles.count = 3;
  particles.position.data = position;
  particles.volume.data = volume;
  particles.mass.data = mass;
  particles.velocity.data = velocity;
  particles.stress.data = stress;
  REFUSED(world, lahar_body_add_particles(world, material, &particles, &body), LAHAR_ERROR_INVALID_ARGUMENT, part);
  CHECK(body == 77);
}

static void bad_numbers(void) {
  const double bad[] = {NAN, INFINITY, -INFINITY, 0, -1};
  const double min[3] = {2, 2, 0}, max[3] = {3, 3, 0};
  double far[3] = {3, NAN, 0};
  lahar_world_options options;
  lahar_world *made;
  lahar_fill fill;
  lahar_wall wall;
  int64_t id;
  int i;
  for (i = 0; i < 5; ++i) {
    if (i < 3) refuse_particle(bad[i], 0, "position");
    refuse_particle(bad[i], 1, "volume");
    refuse_particle(bad[i], 2, "mass");
    if (i < 3) refuse_particle(bad[i], 3, "velocity");
    if (i < 3) refuse_particle(bad[i], 4, "stress");
    if (i == 0) refuse_particle(2e7, 0, "outside the grid"); /* 2e8 cells */
    OK(lahar_world_options_init(&options, sizeof options));
    options.spacing = bad[i];
    made = world;
    EXPECT(lahar_world_create(context, &options, &made), LAHAR_ERROR_INVALID_ARGUMENT, "spacing must be positive");
    CHECK(made == NULL);
    REFUSED(world, lahar_world_step(world, bad[i]), LAHAR_ERROR_INVALID_ARGUMENT, "dt must be positive");
    OK(lahar_fill_init(&fill, sizeof fill));
    fill.mass = bad[i];
    REFUSED(world, lahar_body_add_box(world, material, min, max, &fill, &id), LAHAR_ERROR_INVALID_ARGUMENT, "mass");
    fill.mass = 0;
    fill.density = bad[i];
    REFUSED(world, lahar_body_add_box(world, material, min, max, &fill, &id), LAHAR_ERROR_INVALID_ARGUMENT, "density");
    fill.density = 1000;
    REFUSED(world, lahar_body_add_sphere(world, material, min, bad[i], &fill, &id), LAHAR_ERROR_INVALID_ARGUMENT, "radius");
  }
  REFUSED(world, lahar_body_add_box(world, material, min, far, &fill, &id), LAHAR_ERROR_INVALID_ARGUMENT, "finite");
  REFUSED(world, lahar_body_add_box(world, material, max, min, &fill, &id), LAHAR_ERROR_INVALID_ARGUMENT, "extent");
  fill.particles_per_cell = 0;
  REFUSED(world, lahar_body_add_box(world, material, min, max, &fill, &id), LAHAR_ERROR_INVALID_ARGUMENT, "particles_per_cell");
  REFUSED(world, lahar_world_set_gravity(world, far), LAHAR_ERROR_INVALID_ARGUMENT, "gravity must be finite");
  REFUSED(world, lahar_world_set_damping(world, 1.0), LAHAR_ERROR_INVALID_ARGUMENT, "damping must lie in [0, 1)");
  REFUSED(world, lahar_world_advance(world, NAN, 1, NULL, NULL), LAHAR_ERROR_INVALID_ARGUMENT, "finite time");
  REFUSED(world, lahar_world_advance(world, 1.0, -1, NULL, NULL), LAHAR_ERROR_INVALID_ARGUMENT, "max_steps");
  OK(lahar_wall_init(&wall, sizeof wall));
  wall.position = NAN;
  REFUSED(world, lahar_wall_add(world, &wall, &id), LAHAR_ERROR_INVALID_ARGUMENT, "position must be finite");
  OK(lahar_wall_init(&wall, sizeof wall));
  wall.friction = -0.1;
  REFUSED(world, lahar_wall_add(world, &wall, &id), LAHAR_ERROR_INVALID_ARGUMENT, "friction");
}

static void bad_polygons(void) {
  const double unknown_first[] = {NAN, 0, 1, 0, 0, 1}, unknown_last[] = {0, 0, 1, 0, 0, NAN};
  const double endless[] = {0, 0, INFINITY, 0, 0, 1};
  const double in_a_line[] = {0, 0, 1, 1, 2, 2}, there_and_back[] = {0, 0, 1, 0, 1, 1, 1, 0}, few[] = {0, 0, 1, 1};
  const struct {
    const double *vertices;
    int64_t count;
    const char *part;
  } bad[] = {{unknown_first, 3, "must be finite"}, {unknown_last, 3, "must be finite"}, {endless, 3, "must be finite"},
             {in_a_line, 3, "enclose an area"},    {there_and_back, 4, "enclose an area"}, {few, 2, "3 corners"},
             {in_a_line, -1, "`count` is -1"}};
  lahar_fill fill;
  int64_t id = 77;
  size_t i;
  OK(lahar_fill_init(&fill, sizeof fill));
  fill.density = 1000;
  for (i = 0; i < sizeof bad / sizeof *bad; ++i)
    REFUSED(world, lahar_body_add_polygon(world, material, bad[i].count, bad[i].vertices, &fill, &id), LAHAR_ERROR_INVALID_ARGUMENT,
            bad[i].part);
  CHECK(id == 77);
}

/* A small block with a velocity along x. */
static int64_t add_projectile(lahar_world *flight, double velocity) {
  const double min[3] = {0.4, 0.4, 0}, max[3] = {0.6, 0.6, 0};
  lahar_fill fill;
  int64_t body = -1;
  OK(lahar_fill_init(&fill, sizeof fill));
  fill.density = 1000;
  fill.velocity[0] = velocity;
  OK(lahar_body_add_box(flight, material, min, max, &fill, &body));
  return body;
}

static lahar_world *make_static_world(void) {
  lahar_world_options options;
  lahar_world *made = NULL;
  OK(lahar_world_options_init(&options, sizeof options));
  options.dimension = 2;
  options.spacing = 0.1;
  options.grid_policy = LAHAR_GRID_STATIC;
  options.box_max[0] = options.box_max[1] = 1;
  OK(lahar_world_create(context, &options, &made));
  return made;
}

/* The world waits until the host has brought the particles back or taken the body away. */
static void out_of_a_static_box(void) {
  lahar_world *box = make_static_world();
  int64_t body = add_projectile(box, 5), steps = 0, n = 0;
  lahar_error_info info = {0};
  double position[2 * 64] = {0}, time = 0;
  OK(lahar_body_particle_count(box, body, &n));
  CHECK(n == 16);
  OK(lahar_body_read(box, body, "position", n, position, 0, 0));
  EXPECT(lahar_world_advance(box, 1.0, INT64_MAX, &steps, &time), LAHAR_ERROR_OUTSIDE_GRID, "box");
  CHECK(steps > 0 && time > 0.05 && time < 0.1);
  info.struct_size = sizeof info;
  OK(lahar_last_error_info(&info));
  CHECK(info.body == body && info.particle >= 0 && info.particle < n);
  REFUSED(box, lahar_world_step_auto(box, NULL), LAHAR_ERROR_OUTSIDE_GRID, "box");
  REFUSED(box, lahar_world_step(box, 1e-6), LAHAR_ERROR_OUTSIDE_GRID, "box");
  OK(lahar_body_write(box, body, "position", n, position, 0, 0));
  OK(lahar_world_step_auto(box, NULL));
  EXPECT(lahar_world_advance(box, 1.0, INT64_MAX, NULL, NULL), LAHAR_ERROR_OUTSIDE_GRID, "box");
  OK(lahar_body_remove(box, body));
  OK(lahar_world_advance(box, 1.0, INT64_MAX, NULL, &time));
  CHECK(time == 1);
  lahar_world_free(box);
}

static void positions_that_the_host_wrote(void) {
  const double bad[] = {1e300, -2e7};
  lahar_world *flight = make_world(context);
  int64_t body = add_projectile(flight, 0);
  double position[2 * 16] = {0}, kept;
  size_t i;
  OK(lahar_body_read(flight, body, "position", 16, position, 0, 0));
  kept = position[5];
  position[5] = NAN;
  REFUSED(flight, lahar_body_write(flight, body, "position", 16, position, 0, 0), LAHAR_ERROR_INVALID_ARGUMENT, "must be finite");
  for (i = 0; i < sizeof bad / sizeof *bad; ++i) {
    position[5] = bad[i];
    OK(lahar_body_write(flight, body, "position", 16, position, 0, 0));
    REFUSED(flight, lahar_world_step_auto(flight, NULL), LAHAR_ERROR_NON_FINITE_INPUT, "outside the grid");
    REFUSED(flight, lahar_world_advance(flight, 1.0, 5, NULL, NULL), LAHAR_ERROR_NON_FINITE_INPUT, "outside the grid");
  }
  position[5] = kept;
  OK(lahar_body_write(flight, body, "position", 16, position, 0, 0));
  OK(lahar_world_step_auto(flight, NULL));
  lahar_world_free(flight);
}

/* A stable step that is lost in the time of the world must not be taken for ever. */
static void time_that_stands_still(void) {
  lahar_world *fast = make_world(context);
  int64_t steps = -1;
  double time = 0, dt = -1;
  OK(lahar_world_advance(fast, 1.0, INT64_MAX, NULL, NULL));
  add_projectile(fast, 1e20);
  REFUSED(fast, lahar_world_advance(fast, 2.0, INT64_MAX, &steps, &time), LAHAR_ERROR_INVALID_ARGUMENT, "does not change the time");
  CHECK(steps == 0 && time == 1);
  REFUSED(fast, lahar_world_step_auto(fast, &dt), LAHAR_ERROR_INVALID_ARGUMENT, "does not change the time");
  CHECK(dt == -1);
  lahar_world_free(fast);
}

/* Bodies from 4e4 to 4e8 particles, where 256 MB can be had. */
static int bodies_larger_than_memory(void) {
  struct rlimit limit;
  FILE *file = fopen("/proc/self/statm", "r");
  unsigned long pages = 0;
  lahar_fill fill;
  lahar_status status = LAHAR_OK;
  int fitting = 0, refused = 0;
  double side;
  if (!file || fscanf(file, "%lu", &pages) != 1) return 2;
  fclose(file);
  OK(lahar_fill_init(&fill, sizeof fill));
  fill.density = 1000;
  limit.rlim_cur = limit.rlim_max = pages * (rlim_t)sysconf(_SC_PAGESIZE) + ((rlim_t)256 << 20);
  if (setrlimit(RLIMIT_AS, &limit)) return 2;
  for (side = 10; side < 1000; side *= 1.2) {
    const double min[3] = {0, 0, 0}, max[3] = {side, side, 0};
    picture before = take_picture(world), after;
    int64_t id = -1;
    status = lahar_body_add_box(world, material, min, max, &fill, &id);
    if (status == LAHAR_OK) {
      ++fitting;
      OK(lahar_body_remove(world, id));
    } else {
      ++refused;
      EXPECT(status, LAHAR_ERROR_OUT_OF_MEMORY, "MB more");
      CHECK(id == -1);
    }
    after = take_picture(world);
    CHECK(memcmp(&before, &after, sizeof before) == 0);
  }
  CHECK(fitting > 0 && refused > 5 && status == LAHAR_ERROR_OUT_OF_MEMORY);
  return failures != 0;
}

/* In a child, which may end in any way without harm to the other tests. */
static void more_than_memory(void) {
  int status = -1;
  pid_t child = fork();
  CHECK(child >= 0);
  if (child == 0) {
    alarm(60); /* a failed allocation may also hang */
    _exit(bodies_larger_than_memory());
  }
  CHECK(waitpid(child, &status, 0) == child);
  CHECK(WIFEXITED(status) && WEXITSTATUS(status) == 0);
}

static void bad_choices_and_counts(void) {
  lahar_world_options options;
  lahar_wall wall;
  lahar_world *made;
  lahar_particles particles;
  int32_t *const choices[] = {&options.dimension, &options.shape, &options.transfer, &options.order, &options.grid_policy};
  const char *const names[] = {"dimension", "shape", "transfer", "order", "grid_policy"};
  double values[6] = {0};
  int64_t id, index[3];
  lahar_view *view = NULL;
  int i;
  for (i = 0; i < 5; ++i) {
    OK(lahar_world_options_init(&options, sizeof options));
    options.spacing = 0.1;
    *choices[i] = 9;
    EXPECT(lahar_world_create(context, &options, &made), LAHAR_ERROR_INVALID_ARGUMENT, names[i]);
  }
  OK(lahar_wall_init(&wall, sizeof wall));
  wall.kind = 9;
  REFUSED(world, lahar_wall_add(world, &wall, &id), LAHAR_ERROR_INVALID_ARGUMENT, "9");
  OK(lahar_wall_init(&wall, sizeof wall));
  wall.axis = 2;
  REFUSED(world, lahar_wall_add(world, &wall, &id), LAHAR_ERROR_INVALID_ARGUMENT, "axis must be 0 to 1");
  wall.axis = -1;
  REFUSED(world, lahar_wall_add(world, &wall, &id), LAHAR_ERROR_INVALID_ARGUMENT, "`axis` is -1");
  OK(lahar_wall_init(&wall, sizeof wall));
  wall.side = 0;
  REFUSED(world, lahar_wall_add(world, &wall, &id), LAHAR_ERROR_INVALID_ARGUMENT, "side must be 1");
  EXPECT(lahar_context_set_log(context, lahar_log_stderr, NULL, 4), LAHAR_ERROR_INVALID_ARGUMENT, "log level must be 0 (error), 1 (warning), 2 (information) or 3 (detail), got 4");
  REFUSED(world, lahar_body_view(world, 0, "mass", 2, &view), LAHAR_ERROR_INVALID_ARGUMENT, "`access` is 2");
  REFUSED(world, lahar_body_remove(world, 99), LAHAR_ERROR_NOT_FOUND, "no body has the id 99");
  REFUSED(world, lahar_wall_remove(world, 99), LAHAR_ERROR_NOT_FOUND, "no wall has the id 99");
  REFUSED(world, lahar_body_read(world, 0, "mass", 6, values, 0, 0), LAHAR_ERROR_BUFFER_TOO_SMALL, "`count` is 6");
  REFUSED(world, lahar_body_read(world, 0, "mass", -1, values, 0, 0), LAHAR_ERROR_INVALID_ARGUMENT, "`count` is -1");
  REFUSED(world, lahar_grid_sample(world, "mass", -1, values, values, NULL), LAHAR_ERROR_INVALID_ARGUMENT, "`count` is -1");
  REFUSED(world, lahar_grid_sample(world, "mass", INT64_MAX, values, values, NULL), LAHAR_ERROR_INVALID_ARGUMENT, "more than memory can hold");
  REFUSED(world, lahar_grid_node_index(world, -1, index), LAHAR_ERROR_NOT_FOUND, "`node` is -1");
  OK(lahar_particles_init(&particles, sizeof particles));
  particles.density = 1000;
  particles.position.data = particles.volume.data = values;
  particles.count = -3;
  REFUSED(world, lahar_body_add_particles(world, material, &particles, &id), LAHAR_ERROR_INVALID_ARGUMENT, "`count` is -3");
  particles.count = INT64_MAX;
  REFUSED(world, lahar_body_add_particles(world, material, &particles, &id), LAHAR_ERROR_INVALID_ARGUMENT, "`position`: ");
  particles.count = 3;
  particles.position.component_stride = 1;
  REFUSED(world, lahar_body_add_particles(world, material, &particles, &id), LAHAR_ERROR_INVALID_ARGUMENT, "`position`: ");
  particles.position.point_stride = INT64_MAX / 2;
  REFUSED(world, lahar_body_add_particles(world, material, &particles, &id), LAHAR_ERROR_INVALID_ARGUMENT, "`position`: ");
  particles.position.point_stride = -2;
  REFUSED(world, lahar_body_add_particles(world, material, &particles, &id), LAHAR_ERROR_INVALID_ARGUMENT, "positive");
  particles.position.point_stride = 2;
  particles.reserved = 1;
  REFUSED(world, lahar_body_add_particles(world, material, &particles, &id), LAHAR_ERROR_INVALID_ARGUMENT, "`reserved`");
  REFUSED(world, lahar_world_write_vtp(world, ""), LAHAR_ERROR_INVALID_ARGUMENT, "`path` is empty");
  REFUSED(world, lahar_world_write_vtp(world, "particles.vtk"), LAHAR_ERROR_INVALID_ARGUMENT, ".vtp");
  REFUSED(world, lahar_world_write_vtp(world, "/no/such/folder/particles.vtp"), LAHAR_ERROR_FILE, "/no/such/folder");
  EXPECT(lahar_context_load_plugin(context, "\xff\xfe/", NULL), LAHAR_ERROR_INVALID_ARGUMENT, "`name_or_path` is not UTF-8");
}

static void unknown_names_and_parameters(void) {
  const char *good[] = {"youngs_modulus", "poissons_ratio"}, *wrong[] = {"youngs_modul", "poissons_ratio"};
  const char *twice[] = {"youngs_modulus", "youngs_modulus"};
  const double values[] = {1e6, 0.3}, above[] = {1e6, 0.6}, infinite[] = {INFINITY, 0.3};
  lahar_material *made = material;
  lahar_view *view = NULL;
  double value = 5;
  int64_t i = 5;
  EXPECT(lahar_material_create(context, "linear_elstic", 2, good, values, &made), LAHAR_ERROR_UNKNOWN_NAME,
         "did you mean `linear_elastic`?");
  CHECK(made == NULL);
  EXPECT(lahar_material_create(context, "linear_elastic", 2, wrong, values, &made), LAHAR_ERROR_UNKNOWN_NAME,
         "did you mean `youngs_modulus`?");
  EXPECT(lahar_material_create(context, "linear_elastic", 2, twice, values, &made), LAHAR_ERROR_INVALID_ARGUMENT, "given twice");
  EXPECT(lahar_material_create(context, "linear_elastic", 1, good, values, &made), LAHAR_ERROR_MISSING_PARAMETER, "`poissons_ratio`");
  EXPECT(lahar_material_create(context, "linear_elastic", 2, good, above, &made), LAHAR_ERROR_OUT_OF_BOUNDS, "got 0.6");
  EXPECT(lahar_material_create(context, "linear_elastic", 2, good, infinite, &made), LAHAR_ERROR_INVALID_ARGUMENT, "finite");
  CHECK(made == NULL);
  EXPECT(lahar_material_value(material, "youngs_modulos", &value), LAHAR_ERROR_UNKNOWN_NAME, "did you mean `youngs_modulus`?");
  EXPECT(lahar_context_find_model(context, "linear-elastic", &i), LAHAR_ERROR_UNKNOWN_NAME, "did you mean `linear_elastic`?");
  REFUSED(world, lahar_body_find_field(world, 0, "velocty", &i), LAHAR_ERROR_UNKNOWN_NAME, "did you mean `velocity`?");
  REFUSED(world, lahar_body_read(world, 0, "velocty", 1, &value, 0, 0), LAHAR_ERROR_UNKNOWN_NAME, "did you mean `velocity`?");
  REFUSED(world, lahar_body_write(world, 0, "velocty", 1, &value, 0, 0), LAHAR_ERROR_UNKNOWN_NAME, "did you mean `velocity`?");
  REFUSED(world, lahar_body_view(world, 0, "velocty", 0, &view), LAHAR_ERROR_UNKNOWN_NAME, "did you mean `velocity`?");
  REFUSED(world, lahar_grid_read(world, "mas", 1, &i, &value), LAHAR_ERROR_UNKNOWN_NAME, "did you mean `mass`?");
  REFUSED(world, lahar_grid_sample(world, "mas", 1, values, &value, NULL), LAHAR_ERROR_UNKNOWN_NAME, "did you mean `mass`?");
  CHECK(value == 5 && i == 5);
}

static void bad_plugin_files(const char *wrong_major, const char *no_plugin) {
  int64_t plugins = 0, models = 0, after = 0;
  OK(lahar_context_plugin_count(context, &plugins));
  OK(lahar_context_model_count(context, &models));
  EXPECT(lahar_context_load_plugin(context, "/no/such/file.so", NULL), LAHAR_ERROR_PLUGIN_NOT_FOUND, "/no/such/file.so");
  EXPECT(lahar_context_load_plugin(context, "no_such_plugin", NULL), LAHAR_ERROR_PLUGIN_NOT_FOUND, "LAHAR_PLUGIN_PATH");
  EXPECT(lahar_context_load_plugin(context, no_plugin, NULL), LAHAR_ERROR_PLUGIN_INVALID, no_plugin);
  EXPECT(lahar_context_load_plugin(context, wrong_major, NULL), LAHAR_ERROR_PLUGIN_ABI, "2");
  OK(lahar_context_plugin_count(context, &after));
  CHECK(after == plugins);
  OK(lahar_context_model_count(context, &after));
  CHECK(after == models);
}

static void step_larger_than_stable(void) {
  lahar_error_info info = {0};
  double stable = 0;
  OK(lahar_world_stable_dt(world, &stable));
  CHECK(stable > 0 && stable < 1);
  REFUSED(world, lahar_world_step(world, 1.01 * stable), LAHAR_ERROR_STEP_TOO_LARGE, "exceeds the stable one");
  info.struct_size = sizeof info;
  OK(lahar_last_error_info(&info));
  CHECK(info.code == LAHAR_ERROR_STEP_TOO_LARGE && info.suggested_dt == stable);
  OK(lahar_world_step(world, info.suggested_dt));
}

static void views(void) {
  lahar_view *reading = NULL, *writing = NULL, *refused = NULL;
  lahar_view_info info = {0};
  lahar_fill fill;
  const double min[3] = {4, 4, 0}, max[3] = {5, 5, 0};
  double kept;
  int64_t id;
  info.struct_size = sizeof info;
  OK(lahar_fill_init(&fill, sizeof fill));
  fill.density = 1000;
  OK(lahar_body_view(world, 0, "velocity", LAHAR_ACCESS_WRITE, &writing));
  REFUSED(world, lahar_world_step(world, 1e-5), LAHAR_ERROR_VIEW_OPEN, "lahar_view_free");
  REFUSED(world, lahar_world_step_auto(world, NULL), LAHAR_ERROR_VIEW_OPEN, "1 write view(s) open");
  REFUSED(world, lahar_world_advance(world, 1, 1, NULL, NULL), LAHAR_ERROR_VIEW_OPEN, "lahar_view_free");
  REFUSED(world, lahar_body_add_box(world, material, min, max, &fill, &id), LAHAR_ERROR_VIEW_OPEN, "lahar_view_free");
  REFUSED(world, lahar_body_remove(world, 0), LAHAR_ERROR_VIEW_OPEN, "lahar_view_free");
  OK(lahar_view_data(writing, &info));
  kept = info.data[0];
  info.data[0] = NAN; /* found before the next step, and nothing is done */
  lahar_view_free(writing);
  EXPECT(lahar_world_step_auto(world, NULL), LAHAR_ERROR_NON_FINITE_INPUT, "velocity");
  OK(lahar_body_view(world, 0, "velocity", LAHAR_ACCESS_WRITE, &writing));
  OK(lahar_view_data(writing, &info));
  info.data[0] = kept;
  lahar_view_free(writing);
  REFUSED(world, lahar_body_view(world, 0, "mass", 7, &refused), LAHAR_ERROR_INVALID_ARGUMENT, "`access` is 7");
  CHECK(refused == NULL);

  OK(lahar_body_view(world, 0, "position", LAHAR_ACCESS_READ, &reading));
  REFUSED(world, lahar_body_remove(world, 0), LAHAR_ERROR_VIEW_OPEN, "1 view(s) open");
  OK(lahar_view_data(reading, &info));
  OK(lahar_world_step_auto(world, NULL));
  kept = info.data[0]; /* still mapped */
  CHECK(kept == kept);
  REFUSED(world, lahar_view_data(reading, &info), LAHAR_ERROR_VIEW_STALE, "open a new one");
  lahar_view_free(reading);
  OK(lahar_body_view(world, 0, "position", LAHAR_ACCESS_READ, &reading));
  OK(lahar_view_data(reading, &info));
  EXPECT(lahar_world_step(world, 1e3), LAHAR_ERROR_STEP_TOO_LARGE, "stable");
  OK(lahar_view_data(reading, &info)); /* a refused step leaves views alone */
  lahar_view_free(reading);
}

/* A material that goes wrong at the particle with id 7 in the third step. */
static void material_that_goes_wrong(const char *model, lahar_status wanted) {
  lahar_material *bad = NULL;
  lahar_world *sick = make_world(context);
  lahar_error_info info = {0};
  lahar_totals totals = {0};
  double memory[400] = {0}, time = 0;
  char text[1000];
  int64_t body, n = 0, steps = 0, done = -1;
  picture before, after;
  OK(lahar_material_create(context, model, 0, NULL, NULL, &bad));
  body = add_block(sick, bad, 1e4);
  OK(lahar_body_particle_count(sick, body, &n));
  CHECK(n == 400);
  memory[7] = 3;
  OK(lahar_body_write(sick, body, "memory", n, memory, 0, 0));
  EXPECT(lahar_world_advance(sick, 1.0, 10, &done, &time), wanted, "particle 7 of body 0");
  CHECK(done == 2 && time > 0);
  info.struct_size = sizeof info;
  OK(lahar_last_error_info(&info));
  CHECK(info.particle == 7 && info.body == body && info.step == 2 && info.time == time);
  OK(lahar_context_error_message(context, text, sizeof text, NULL));
  CHECK(strstr(text, "particle 7") != NULL);
  before = take_picture(sick);
  EXPECT(lahar_world_step_auto(sick, NULL), LAHAR_ERROR_POISONED, "queried and freed");
  EXPECT(lahar_world_set_damping(sick, 0.1), LAHAR_ERROR_POISONED, "queried and freed");
  EXPECT(lahar_body_remove(sick, body), LAHAR_ERROR_POISONED, "queried and freed");
  EXPECT(lahar_body_write(sick, body, "memory", n, memory, 0, 0), LAHAR_ERROR_POISONED, "queried and freed");
  after = take_picture(sick);
  CHECK(memcmp(&before, &after, sizeof before) == 0);
  OK(lahar_world_step_count(sick, &steps));
  CHECK(steps == 2);
  totals.struct_size = sizeof totals;
  OK(lahar_world_totals(sick, body, &totals));
  CHECK(totals.particles == 400);
  OK(lahar_body_read(sick, body, "memory", n, memory, 0, 0));
  lahar_world_free(sick);
  lahar_material_free(bad);
}

typedef struct {
  lahar_world *world;
  int64_t steps, busy, other;
} stepper;

static volatile int seen_busy = 0;

static void *step_many(void *argument) {
  stepper *me = argument;
  int i;
  for (i = 0; i < 100000 && (i < 200 || !seen_busy); ++i) {
    lahar_status status = lahar_world_step(me->world, 1e-5);
    if (status == LAHAR_OK) ++me->steps;
    else if (status == LAHAR_ERROR_BUSY) ++me->busy, seen_busy = 1;
    else ++me->other;
  }
  return NULL;
}

static void two_threads_step_one_world(void) {
  lahar_world *shared = make_world(context), *alone = make_world(context);
  stepper a = {NULL, 0, 0, 0}, b = {NULL, 0, 0, 0};
  pthread_t other;
  picture p, q;
  int64_t steps = 0;
  add_block(shared, material, 1000);
  add_block(alone, material, 1000);
  a.world = b.world = shared;
  CHECK(pthread_create(&other, NULL, step_many, &b) == 0);
  step_many(&a);
  pthread_join(other, NULL);
  OK(lahar_world_step_count(shared, &steps));
  CHECK(a.busy + b.busy > 0);
  CHECK(a.other == 0 && b.other == 0);
  CHECK(steps == a.steps + b.steps);
  for (; steps > 0; --steps) OK(lahar_world_step(alone, 1e-5));
  p = take_picture(shared);
  q = take_picture(alone);
  CHECK(memcmp(&p, &q, sizeof p) == 0); /* the same steps, bit for bit */
  lahar_world_free(shared);
  lahar_world_free(alone);
}

int main(int argc, char **argv) {
  if (argc < 6) return 2;
  context = make_context((const char *const[]){argv[1], argv[2], NULL});
  OK(lahar_context_load_plugin(context, argv[3], NULL));
  material = make_elastic(context);
  world = make_world(context);
  if (failures) return 1;
  add_block(world, material, 1000);
  OK(lahar_world_step_auto(world, NULL));
  wrong_struct_size();
  bad_texts();
  static_grid_larger_than_memory();
  stable_step_of_no_particles();
  bad_numbers();
  bad_polygons();
  bad_choices_and_counts();
  unknown_names_and_parameters();
  bad_plugin_files(argv[4], argv[5]);
  step_larger_than_stable();
  views();
  out_of_a_static_box();
  positions_that_the_host_wrote();
  time_that_stands_still();
  more_than_memory();
  material_that_goes_wrong("nan_model", LAHAR_ERROR_NON_FINITE);
  material_that_goes_wrong("failing_model", LAHAR_ERROR_MATERIAL_FAILED);
  two_threads_step_one_world();
  lahar_world_free(world);
  lahar_material_free(material);
  lahar_context_free(context);
  return failures != 0;
}
