/* The grid shows the particles and loads as they are: a query between two changes hides none of them. The elastic plugin is
 * found by LAHAR_PLUGIN_PATH. */
#include "check.h"

/* A block of 1 m x 1 m and 2000 kg that nothing holds. */
static lahar_world *make_free_block(lahar_context *context, const lahar_material *material) {
  const double min[3] = {0, 0, 0}, max[3] = {1, 1, 0};
  lahar_world_options options;
  lahar_fill fill;
  lahar_world *world = NULL;
  int64_t body = -1;
  OK(lahar_world_options_init(&options, sizeof options));
  options.dimension = 2;
  options.spacing = 0.25;
  options.body_force = 1;
  OK(lahar_world_create(context, &options, &world));
  OK(lahar_fill_init(&fill, sizeof fill));
  fill.density = 2000;
  OK(lahar_body_add_box(world, material, min, max, &fill, &body));
  CHECK(body == 0);
  return world;
}

static double unbalanced(lahar_world *world) {
  lahar_equilibrium e = {0};
  e.struct_size = sizeof e;
  OK(lahar_world_equilibrium(world, &e));
  return e.unbalanced_force;
}

static int near(double a, double b) { return fabs(a - b) <= 1e-9 * fabs(b) + 1e-9; }

/* 1 kPa on the top, 1 m long. */
static int64_t load_top(lahar_world *world) {
  lahar_traction t;
  int64_t id = -1;
  OK(lahar_traction_init(&t, sizeof t));
  t.body = 0;
  t.axis = 1;
  t.box_min[0] = t.box_min[2] = -1;
  t.box_max[0] = t.box_max[2] = 2;
  t.box_min[1] = 0.9;
  t.box_max[1] = 1;
  t.traction[1] = -1e3;
  OK(lahar_traction_add(world, &t, &id));
  return id;
}

static void write(lahar_world *world, const char *field, int components, const double *value) {
  int64_t n = 0, k;
  double *all;
  int c;
  OK(lahar_body_particle_count(world, 0, &n));
  all = malloc((size_t)(n * components) * sizeof *all);
  for (k = 0; k < n; ++k)
    for (c = 0; c < components; ++c) all[k * components + c] = value[c];
  OK(lahar_body_write(world, 0, field, n, all, 0, 0));
  free(all);
}

static lahar_view *open_stress(lahar_world *world, lahar_view_info *info) {
  lahar_view *view = NULL;
  OK(lahar_body_view(world, 0, "stress", LAHAR_ACCESS_WRITE, &view));
  info->struct_size = sizeof *info;
  OK(lahar_view_data(view, info));
  return view;
}

static void press(const lahar_view_info *info) {
  int64_t k;
  for (k = 0; k < info->count; ++k) info->data[k] = info->data[info->stride + k] = -1e3;
}

/* Stresses xx and yy of -1 kPa: the same whether the world was asked before or not, by whatever way they come. */
static void stresses(lahar_context *context, const lahar_material *material) {
  const double pressed[6] = {-1e3, -1e3, 0, 0, 0, 0};
  double right = 0;
  int way, asked;
  for (way = 0; way < 3; ++way)
    for (asked = 0; asked < 2; ++asked) {
      lahar_world *world = make_free_block(context, material);
      if (asked) CHECK(unbalanced(world) == 0);
      if (way < 2) write(world, "stress", 6, pressed);
      if (way == 1) OK(lahar_body_init_state(world, 0));
      if (way == 2) {
        lahar_view_info info = {0};
        lahar_view *view = open_stress(world, &info);
        press(&info);
        if (asked) CHECK(unbalanced(world) == 0); /* counts from the end of the view on */
        lahar_view_free(view);
      }
      if (way + asked == 0) right = unbalanced(world);
      CHECK(right > 1e3 && unbalanced(world) == right);
      lahar_world_free(world);
    }
}

static void add_floor(lahar_world *world) {
  lahar_wall wall;
  OK(lahar_wall_init(&wall, sizeof wall));
  wall.axis = 1;
  wall.kind = LAHAR_WALL_STICKY;
  OK(lahar_wall_add(world, &wall, NULL));
}

/* Velocity at a node of the floor. */
static void floor_velocity(lahar_world *world, double v[2]) {
  const double point[2] = {0.5, 0};
  OK(lahar_grid_sample(world, "velocity", 1, point, v, NULL));
}

/* After a step the grid is that of the step, by whatever way stresses were written before; and what is mapped anew keeps to
 * the floor. */
static void floors(lahar_context *context, const lahar_material *material) {
  const double pressed[6] = {-1e3, -1e3, 0, 0, 0, 0}, none[2] = {0, 0};
  double v[2][2], forces[2];
  int way;
  for (way = 0; way < 2; ++way) {
    lahar_world *world = make_free_block(context, material);
    add_floor(world);
    if (way == 0) write(world, "stress", 6, pressed);
    if (way == 1) {
      lahar_view_info info = {0};
      lahar_view *view = open_stress(world, &info);
      press(&info);
      lahar_view_free(view);
    }
    OK(lahar_world_step_auto(world, NULL));
    floor_velocity(world, v[way]);
    forces[way] = unbalanced(world);
    write(world, "body_force", 2, none);
    {
      int64_t node = -1;
      const int64_t index[3] = {2, 0, 0};
      double held[2] = {1, 1};
      OK(lahar_grid_find_node(world, index, &node));
      OK(lahar_grid_read(world, "velocity", 1, &node, held));
      CHECK(held[0] == 0 && held[1] == 0);
    }
    lahar_world_free(world);
  }
  CHECK(!memcmp(v[0], v[1], sizeof v[0]) && forces[0] == forces[1]);
}

/* A refused step leaves views as they are, also after a write that moves nothing. */
static void refused(lahar_context *context, const lahar_material *material) {
  const double pressed[6] = {-1e3, -1e3, 0, 0, 0, 0};
  lahar_view_info info = {0};
  lahar_view *view = NULL;
  lahar_world *world = make_free_block(context, material);
  OK(lahar_world_step_auto(world, NULL));
  OK(lahar_body_view(world, 0, "stress", LAHAR_ACCESS_READ, &view));
  write(world, "stress", 6, pressed);
  EXPECT(lahar_world_step(world, 1e3), LAHAR_ERROR_STEP_TOO_LARGE, "exceeds");
  info.struct_size = sizeof info;
  OK(lahar_view_data(view, &info));
  lahar_view_free(view);
  lahar_world_free(world);
}

int main(void) {
  const double down[3] = {0, -10, 0}, none[2] = {0, 0}, force[2] = {0, -10};
  lahar_context *context = NULL;
  lahar_material *material;
  lahar_world *world;
  double f[3] = {1, 1, 1};
  int64_t load;
  OK(lahar_context_create(1, &context));
  OK(lahar_context_load_plugin(context, "lahar_linear_elastic", NULL));
  material = make_elastic(context);

  world = make_free_block(context, material);
  CHECK(unbalanced(world) == 0);
  load = load_top(world);
  CHECK(near(unbalanced(world), 1e3));
  OK(lahar_traction_force(world, load, NULL, NULL, f));
  CHECK(f[1] == 0); /* there was no step */
  OK(lahar_traction_remove(world, load));
  CHECK(unbalanced(world) == 0);

  OK(lahar_world_set_gravity(world, down));
  CHECK(near(unbalanced(world), 2e4));
  write(world, "body_force", 2, force);
  CHECK(near(unbalanced(world), 4e4));
  write(world, "body_force", 2, none);
  CHECK(near(unbalanced(world), 2e4));

  /* after a step the forces are those of the step, until something changes */
  OK(lahar_world_step_auto(world, NULL));
  CHECK(near(unbalanced(world), 2e4));
  load = load_top(world);
  CHECK(near(unbalanced(world), 2.1e4));
  OK(lahar_world_step_auto(world, NULL));
  OK(lahar_traction_force(world, load, NULL, NULL, f));
  CHECK(near(f[1], -1e3));
  OK(lahar_traction_remove(world, load));
  lahar_world_free(world);

  stresses(context, material);
  floors(context, material);
  refused(context, material);
  lahar_material_free(material);
  lahar_context_free(context);
  return failures != 0;
}
