/* NULL for every pointer of every function: refused with the name of the argument and nothing changed, or allowed where
 * the header says so. A test compares the list of NULL_REFUSED and NULL_ALLOWED with the header, so none is forgotten. */
#include "check.h"

#include "../bad_plugins/minimal.h"

static void spoil(void) {}

static int32_t go_on(int64_t steps, double time, void *user) { return (void)steps, (void)time, user != NULL; }

static lahar_world *world;

/* Function, argument, arguments of the call. */
#define NULL_REFUSED(function, argument, arguments) \
  REFUSED(world, function arguments, LAHAR_ERROR_NULL_ARGUMENT, "`" #argument "` is NULL")
#define NULL_ALLOWED(function, argument, arguments) OK(function arguments)
#define NULL_IGNORED(function, argument, arguments) function arguments

static lahar_context *context;
static lahar_material *material;
static int64_t integer, body;
static int32_t small;
static double number, numbers[4096];

static void context_functions(void) {
  lahar_plugin_info plugin = {0};
  lahar_context *other;
  char text[100];
  NULL_REFUSED(lahar_version, major, (NULL, &small, &small));
  NULL_REFUSED(lahar_version, minor, (&small, NULL, &small));
  NULL_REFUSED(lahar_version, patch, (&small, &small, NULL));
  NULL_REFUSED(lahar_context_create, context, (1, NULL));
  NULL_IGNORED(lahar_context_free, context, (NULL));
  NULL_REFUSED(lahar_context_thread_count, context, (NULL, &small));
  NULL_REFUSED(lahar_context_thread_count, threads, (context, NULL));
  NULL_IGNORED(lahar_context_simd, context, (NULL));
  NULL_REFUSED(lahar_context_threads_used, context, (NULL, &small));
  NULL_REFUSED(lahar_context_threads_used, threads, (context, NULL));
  NULL_REFUSED(lahar_context_set_log, context, (NULL, lahar_log_stderr, NULL, 1));
  NULL_ALLOWED(lahar_context_set_log, user, (context, lahar_log_stderr, NULL, LAHAR_LOG_WARNING));
  OK(lahar_context_set_log(context, NULL, NULL, LAHAR_LOG_WARNING));
  NULL_IGNORED(lahar_log_stderr, message, (LAHAR_LOG_ERROR, NULL, NULL));
  NULL_IGNORED(lahar_log_stderr, user, (LAHAR_LOG_ERROR, NULL, NULL));
  NULL_REFUSED(lahar_context_load_plugin, context, (NULL, "x", &integer));
  NULL_REFUSED(lahar_context_load_plugin, name_or_path, (context, NULL, &integer));
  NULL_REFUSED(lahar_context_register_plugin, context, (NULL, lahar_plugin_entry_v1, &integer));
  EXPECT(lahar_context_register_plugin(context, NULL, &integer), LAHAR_ERROR_NULL_ARGUMENT, "`plugin` is NULL");
  NULL_ALLOWED(lahar_context_register_plugin, index, (context, lahar_plugin_entry_v1, NULL));
  NULL_REFUSED(lahar_context_set_capsule_folder, context, (NULL, "."));
  NULL_ALLOWED(lahar_context_set_capsule_folder, folder, (context, NULL));
  NULL_REFUSED(lahar_context_plugin_count, context, (NULL, &integer));
  NULL_REFUSED(lahar_context_plugin_count, plugins, (context, NULL));
  plugin.struct_size = sizeof plugin;
  NULL_REFUSED(lahar_context_plugin_info, context, (NULL, 0, &plugin));
  NULL_REFUSED(lahar_context_plugin_info, info, (context, 0, NULL));
  EXPECT(lahar_context_create(-1, &other), LAHAR_ERROR_INVALID_ARGUMENT, "`threads` is -1");
  CHECK(other == NULL);
  CHECK(lahar_last_error_message(NULL, 100, &integer) == LAHAR_ERROR_NULL_ARGUMENT);
  NULL_ALLOWED(lahar_last_error_message, buffer, (NULL, 0, &integer));
  NULL_ALLOWED(lahar_last_error_message, needed, (text, sizeof text, NULL));
  CHECK(lahar_last_error_info(NULL) == LAHAR_ERROR_NULL_ARGUMENT);
  CHECK(lahar_context_error_message(NULL, text, sizeof text, NULL) == LAHAR_ERROR_NULL_ARGUMENT);
  NULL_ALLOWED(lahar_context_error_message, buffer, (context, NULL, 0, &integer));
  NULL_ALLOWED(lahar_context_error_message, needed, (context, text, sizeof text, NULL));
  CHECK(lahar_last_error_message(text, 10, &integer) == LAHAR_ERROR_BUFFER_TOO_SMALL);
  CHECK(strlen(text) == 9 && strncmp(text, "lahar_con", 9) == 0 && integer > 10);
}

static void model_functions(void) {
  lahar_model_info model = {0};
  lahar_parameter_info parameter = {0};
  lahar_state_info state = {0};
  const char *names[] = {"youngs_modulus", NULL};
  const double values[] = {1e6, 0.3};
  lahar_material *made = material;
  model.struct_size = sizeof model;
  parameter.struct_size = sizeof parameter;
  state.struct_size = sizeof state;
  NULL_REFUSED(lahar_context_model_count, context, (NULL, &integer));
  NULL_REFUSED(lahar_context_model_count, models, (context, NULL));
  NULL_REFUSED(lahar_context_model_info, context, (NULL, 0, &model));
  NULL_REFUSED(lahar_context_model_info, info, (context, 0, NULL));
  NULL_REFUSED(lahar_context_find_model, context, (NULL, "linear_elastic", &integer));
  NULL_REFUSED(lahar_context_find_model, name, (context, NULL, &integer));
  NULL_REFUSED(lahar_context_find_model, model, (context, "linear_elastic", NULL));
  NULL_REFUSED(lahar_context_model_parameter, context, (NULL, 0, 0, &parameter));
  NULL_REFUSED(lahar_context_model_parameter, info, (context, 0, 0, NULL));
  NULL_REFUSED(lahar_context_model_state, context, (NULL, 0, 0, &state));
  NULL_REFUSED(lahar_context_model_state, info, (context, 0, 0, NULL));
  NULL_REFUSED(lahar_material_create, context, (NULL, "linear_elastic", 1, names, values, &made));
  CHECK(made == NULL);
  NULL_REFUSED(lahar_material_create, model, (context, NULL, 1, names, values, &made));
  NULL_REFUSED(lahar_material_create, names, (context, "linear_elastic", 1, NULL, values, &made));
  NULL_REFUSED(lahar_material_create, values, (context, "linear_elastic", 1, names, NULL, &made));
  NULL_REFUSED(lahar_material_create, material, (context, "linear_elastic", 1, names, values, NULL));
  EXPECT(lahar_material_create(context, "linear_elastic", 2, names, values, &made), LAHAR_ERROR_NULL_ARGUMENT,
         "`names[1]` is NULL");
  NULL_IGNORED(lahar_material_free, material, (NULL));
  NULL_REFUSED(lahar_material_value, material, (NULL, "youngs_modulus", &number));
  NULL_REFUSED(lahar_material_value, parameter, (material, NULL, &number));
  NULL_REFUSED(lahar_material_value, value, (material, "youngs_modulus", NULL));
}

static void world_functions(void) {
  lahar_world_options options;
  lahar_totals totals = {0};
  lahar_world *made = world;
  const double gravity[3] = {0, -9.81, 0};
  totals.struct_size = sizeof totals;
  OK(lahar_world_options_init(&options, sizeof options));
  options.spacing = 1.0;
  NULL_REFUSED(lahar_world_options_init, options, (NULL, sizeof options));
  NULL_REFUSED(lahar_world_create, context, (NULL, &options, &made));
  CHECK(made == NULL);
  NULL_REFUSED(lahar_world_create, options, (context, NULL, &made));
  NULL_REFUSED(lahar_world_create, world, (context, &options, NULL));
  NULL_IGNORED(lahar_world_free, world, (NULL));
  NULL_REFUSED(lahar_world_set_gravity, world, (NULL, gravity));
  NULL_REFUSED(lahar_world_set_gravity, gravity, (world, NULL));
  NULL_REFUSED(lahar_world_set_damping, world, (NULL, 0.1));
  NULL_REFUSED(lahar_world_step, world, (NULL, 1e-4));
  NULL_REFUSED(lahar_world_step_auto, world, (NULL, &number));
  NULL_ALLOWED(lahar_world_step_auto, dt, (world, NULL));
  OK(lahar_world_time(world, &number));
  NULL_REFUSED(lahar_world_advance, world, (NULL, number, 1, &integer, &number));
  NULL_ALLOWED(lahar_world_advance, steps_done, (world, number + 1e-4, 1, NULL, &number));
  NULL_ALLOWED(lahar_world_advance, time, (world, number + 1e-4, 1, &integer, NULL));
  NULL_REFUSED(lahar_world_stable_dt, world, (NULL, &number));
  NULL_REFUSED(lahar_world_stable_dt, dt, (world, NULL));
  NULL_REFUSED(lahar_world_time, world, (NULL, &number));
  NULL_REFUSED(lahar_world_time, time, (world, NULL));
  NULL_REFUSED(lahar_world_step_count, world, (NULL, &integer));
  NULL_REFUSED(lahar_world_step_count, steps, (world, NULL));
  NULL_REFUSED(lahar_world_last_dt, world, (NULL, &number));
  NULL_REFUSED(lahar_world_last_dt, dt, (world, NULL));
  NULL_REFUSED(lahar_world_totals, world, (NULL, LAHAR_ALL_BODIES, &totals));
  NULL_REFUSED(lahar_world_totals, totals, (world, LAHAR_ALL_BODIES, NULL));
  NULL_REFUSED(lahar_world_write_vtp, world, (NULL, "x.vtp"));
  NULL_REFUSED(lahar_world_write_vtp, path, (world, NULL));
}

static void body_functions(void) {
  const double min[3] = {0, 0, 0}, max[3] = {1, 1, 0}, triangle[] = {0, 0, 1, 0, 0, 1}, volume = 1e-3;
  lahar_particles particles;
  lahar_fill fill;
  OK(lahar_particles_init(&particles, sizeof particles));
  OK(lahar_fill_init(&fill, sizeof fill));
  fill.density = 1000;
  particles.count = 1;
  particles.density = 1000;
  particles.position.data = min;
  particles.volume.data = &volume;
  NULL_REFUSED(lahar_particles_init, particles, (NULL, sizeof particles));
  NULL_REFUSED(lahar_fill_init, fill, (NULL, sizeof fill));
  NULL_REFUSED(lahar_body_add_particles, world, (NULL, material, &particles, &body));
  NULL_REFUSED(lahar_body_add_particles, material, (world, NULL, &particles, &body));
  NULL_REFUSED(lahar_body_add_particles, particles, (world, material, NULL, &body));
  NULL_REFUSED(lahar_body_add_particles, body, (world, material, &particles, NULL));
  particles.position.data = NULL;
  REFUSED(world, lahar_body_add_particles(world, material, &particles, &body), LAHAR_ERROR_NULL_ARGUMENT, "`position` is NULL");
  particles.position.data = min;
  particles.volume.data = NULL;
  REFUSED(world, lahar_body_add_particles(world, material, &particles, &body), LAHAR_ERROR_NULL_ARGUMENT, "`volume` is NULL");
  NULL_REFUSED(lahar_body_add_box, world, (NULL, material, min, max, &fill, &body));
  NULL_REFUSED(lahar_body_add_box, material, (world, NULL, min, max, &fill, &body));
  NULL_REFUSED(lahar_body_add_box, min, (world, material, NULL, max, &fill, &body));
  NULL_REFUSED(lahar_body_add_box, max, (world, material, min, NULL, &fill, &body));
  NULL_REFUSED(lahar_body_add_box, fill, (world, material, min, max, NULL, &body));
  NULL_REFUSED(lahar_body_add_box, body, (world, material, min, max, &fill, NULL));
  NULL_REFUSED(lahar_body_add_sphere, world, (NULL, material, min, 1, &fill, &body));
  NULL_REFUSED(lahar_body_add_sphere, material, (world, NULL, min, 1, &fill, &body));
  NULL_REFUSED(lahar_body_add_sphere, center, (world, material, NULL, 1, &fill, &body));
  NULL_REFUSED(lahar_body_add_sphere, fill, (world, material, min, 1, NULL, &body));
  NULL_REFUSED(lahar_body_add_sphere, body, (world, material, min, 1, &fill, NULL));
  NULL_REFUSED(lahar_body_add_polygon, world, (NULL, material, 3, triangle, &fill, &body));
  NULL_REFUSED(lahar_body_add_polygon, material, (world, NULL, 3, triangle, &fill, &body));
  NULL_REFUSED(lahar_body_add_polygon, vertices, (world, material, 3, NULL, &fill, &body));
  NULL_REFUSED(lahar_body_add_polygon, fill, (world, material, 3, triangle, NULL, &body));
  NULL_REFUSED(lahar_body_add_polygon, body, (world, material, 3, triangle, &fill, NULL));
  NULL_REFUSED(lahar_body_remove, world, (NULL, 0));
  NULL_REFUSED(lahar_body_set_f_bar, world, (NULL, 0, 1));
  NULL_REFUSED(lahar_world_body_count, world, (NULL, &integer));
  NULL_REFUSED(lahar_world_body_count, bodies, (world, NULL));
  NULL_REFUSED(lahar_world_bodies, world, (NULL, 1, &body, &integer));
  NULL_REFUSED(lahar_world_bodies, ids, (world, 1, NULL, &integer));
  NULL_REFUSED(lahar_world_bodies, count, (world, 1, &body, NULL));
  OK(lahar_world_bodies(world, 0, NULL, &integer));
  NULL_REFUSED(lahar_body_particle_count, world, (NULL, 0, &integer));
  NULL_REFUSED(lahar_body_particle_count, particles, (world, 0, NULL));
}

static void field_functions(void) {
  lahar_field_info info = {0};
  lahar_view_info data = {0};
  lahar_view *view = NULL;
  int64_t n = 0;
  info.struct_size = sizeof info;
  data.struct_size = sizeof data;
  OK(lahar_body_particle_count(world, 0, &n));
  CHECK(2 * n <= (int64_t)(sizeof numbers / sizeof *numbers));
  NULL_REFUSED(lahar_body_field_count, world, (NULL, 0, &integer));
  NULL_REFUSED(lahar_body_field_count, fields, (world, 0, NULL));
  NULL_REFUSED(lahar_body_field_info, world, (NULL, 0, 0, &info));
  NULL_REFUSED(lahar_body_field_info, info, (world, 0, 0, NULL));
  NULL_REFUSED(lahar_body_find_field, world, (NULL, 0, "mass", &integer));
  NULL_REFUSED(lahar_body_find_field, name, (world, 0, NULL, &integer));
  NULL_REFUSED(lahar_body_find_field, field, (world, 0, "mass", NULL));
  NULL_REFUSED(lahar_body_read, world, (NULL, 0, "mass", n, numbers, 0, 0));
  NULL_REFUSED(lahar_body_read, field, (world, 0, NULL, n, numbers, 0, 0));
  NULL_REFUSED(lahar_body_read, values, (world, 0, "mass", n, NULL, 0, 0));
  NULL_REFUSED(lahar_body_write, world, (NULL, 0, "velocity", n, numbers, 0, 0));
  NULL_REFUSED(lahar_body_write, field, (world, 0, NULL, n, numbers, 0, 0));
  NULL_REFUSED(lahar_body_write, values, (world, 0, "velocity", n, NULL, 0, 0));
  NULL_REFUSED(lahar_body_ids, world, (NULL, 0, 1, &body, &integer));
  NULL_REFUSED(lahar_body_ids, ids, (world, 0, n, NULL, &integer));
  NULL_REFUSED(lahar_body_ids, count, (world, 0, 1, &body, NULL));
  NULL_REFUSED(lahar_body_view, world, (NULL, 0, "mass", LAHAR_ACCESS_READ, &view));
  NULL_REFUSED(lahar_body_view, field, (world, 0, NULL, LAHAR_ACCESS_READ, &view));
  NULL_REFUSED(lahar_body_view, view, (world, 0, "mass", LAHAR_ACCESS_READ, NULL));
  OK(lahar_body_view(world, 0, "mass", LAHAR_ACCESS_READ, &view));
  NULL_REFUSED(lahar_view_data, view, (NULL, &data));
  NULL_REFUSED(lahar_view_data, info, (view, NULL));
  NULL_IGNORED(lahar_view_free, view, (NULL));
  lahar_view_free(view);
}

static void wall_and_grid_functions(void) {
  lahar_wall wall;
  lahar_grid_statistics statistics = {0};
  lahar_field_info info = {0};
  const int64_t index[3] = {5, 5, 0};
  int64_t back[3], node = -1;
  const double point[2] = {0.5, 0.5};
  statistics.struct_size = sizeof statistics;
  info.struct_size = sizeof info;
  OK(lahar_wall_init(&wall, sizeof wall));
  wall.position = -5;
  NULL_REFUSED(lahar_wall_init, wall, (NULL, sizeof wall));
  NULL_REFUSED(lahar_wall_add, world, (NULL, &wall, &integer));
  NULL_REFUSED(lahar_wall_add, wall, (world, NULL, &integer));
  NULL_ALLOWED(lahar_wall_add, id, (world, &wall, NULL));
  NULL_REFUSED(lahar_wall_remove, world, (NULL, 1));
  NULL_REFUSED(lahar_wall_reaction, world, (NULL, 0, numbers));
  NULL_REFUSED(lahar_wall_reaction, force, (world, 0, NULL));
  NULL_REFUSED(lahar_grid_stats, world, (NULL, &statistics));
  NULL_REFUSED(lahar_grid_stats, statistics, (world, NULL));
  NULL_REFUSED(lahar_grid_blocks, world, (NULL, 1, back, &integer));
  NULL_REFUSED(lahar_grid_blocks, coordinates, (world, 1, NULL, &integer));
  NULL_REFUSED(lahar_grid_blocks, count, (world, 1, back, NULL));
  NULL_REFUSED(lahar_grid_find_node, world, (NULL, index, &node));
  NULL_REFUSED(lahar_grid_find_node, index, (world, NULL, &node));
  NULL_REFUSED(lahar_grid_find_node, node, (world, index, NULL));
  OK(lahar_grid_find_node(world, index, &node));
  NULL_REFUSED(lahar_grid_node_index, world, (NULL, node, back));
  NULL_REFUSED(lahar_grid_node_index, index, (world, node, NULL));
  OK(lahar_grid_node_index(world, node, back));
  CHECK(memcmp(back, index, sizeof back) == 0);
  NULL_REFUSED(lahar_grid_field_count, world, (NULL, &integer));
  NULL_REFUSED(lahar_grid_field_count, fields, (world, NULL));
  NULL_REFUSED(lahar_grid_field_info, world, (NULL, 0, &info));
  NULL_REFUSED(lahar_grid_field_info, info, (world, 0, NULL));
  NULL_REFUSED(lahar_grid_read, world, (NULL, "mass", 1, &node, numbers));
  NULL_REFUSED(lahar_grid_read, field, (world, NULL, 1, &node, numbers));
  OK(lahar_grid_stats(world, &statistics));
  CHECK(statistics.active_nodes <= (int64_t)(sizeof numbers / sizeof *numbers));
  NULL_ALLOWED(lahar_grid_read, nodes, (world, "mass", statistics.active_nodes, NULL, numbers));
  NULL_REFUSED(lahar_grid_read, values, (world, "mass", 1, &node, NULL));
  NULL_REFUSED(lahar_grid_sample, world, (NULL, "mass", 1, point, numbers, &small));
  NULL_REFUSED(lahar_grid_sample, field, (world, NULL, 1, point, numbers, &small));
  NULL_REFUSED(lahar_grid_sample, points, (world, "mass", 1, NULL, numbers, &small));
  NULL_REFUSED(lahar_grid_sample, values, (world, "mass", 1, point, NULL, &small));
  NULL_ALLOWED(lahar_grid_sample, inside, (world, "mass", 1, point, numbers, NULL));
}

static void condition_functions(void) {
  const double gravity[3] = {0, -9.81, 0}, time = 0;
  lahar_prescribed_velocity velocity;
  lahar_traction traction;
  lahar_equilibrium equilibrium = {0};
  lahar_settle_criteria criteria;
  lahar_settle_result result = {0};
  int d;
  equilibrium.struct_size = sizeof equilibrium;
  result.struct_size = sizeof result;
  NULL_REFUSED(lahar_world_set_gravity_table, world, (NULL, 1, &time, gravity));
  NULL_REFUSED(lahar_world_set_gravity_table, times, (world, 1, NULL, gravity));
  NULL_REFUSED(lahar_world_set_gravity_table, values, (world, 1, &time, NULL));
  OK(lahar_prescribed_velocity_init(&velocity, sizeof velocity));
  velocity.components = LAHAR_COMPONENT_X;
  for (d = 0; d < 3; ++d) velocity.box_min[d] = velocity.box_max[d] = -9;
  NULL_REFUSED(lahar_prescribed_velocity_init, condition, (NULL, sizeof velocity));
  NULL_REFUSED(lahar_prescribed_velocity_add, world, (NULL, &velocity, &integer));
  NULL_REFUSED(lahar_prescribed_velocity_add, condition, (world, NULL, &integer));
  NULL_ALLOWED(lahar_prescribed_velocity_add, id, (world, &velocity, NULL));
  NULL_REFUSED(lahar_prescribed_velocity_reaction, world, (NULL, 0, numbers));
  NULL_REFUSED(lahar_prescribed_velocity_reaction, force, (world, 0, NULL));
  NULL_REFUSED(lahar_prescribed_velocity_remove, world, (NULL, 0));
  OK(lahar_traction_init(&traction, sizeof traction));
  traction.body = 0;
  for (d = 0; d < 2; ++d) traction.box_min[d] = 0, traction.box_max[d] = 1;
  traction.box_min[0] = 0.95;
  NULL_REFUSED(lahar_traction_init, traction, (NULL, sizeof traction));
  NULL_REFUSED(lahar_traction_add, world, (NULL, &traction, &integer));
  NULL_REFUSED(lahar_traction_add, traction, (world, NULL, &integer));
  NULL_ALLOWED(lahar_traction_add, id, (world, &traction, NULL));
  NULL_REFUSED(lahar_traction_force, world, (NULL, 0, &integer, &number, numbers));
  NULL_ALLOWED(lahar_traction_force, particles, (world, 0, NULL, &number, numbers));
  NULL_ALLOWED(lahar_traction_force, area, (world, 0, &integer, NULL, numbers));
  NULL_REFUSED(lahar_traction_force, force, (world, 0, &integer, &number, NULL));
  NULL_REFUSED(lahar_traction_remove, world, (NULL, 0));
  NULL_REFUSED(lahar_world_equilibrium, world, (NULL, &equilibrium));
  NULL_REFUSED(lahar_world_equilibrium, equilibrium, (world, NULL));
  OK(lahar_settle_criteria_init(&criteria, sizeof criteria));
  NULL_REFUSED(lahar_settle_criteria_init, criteria, (NULL, sizeof criteria));
  criteria.max_steps = 1;
  NULL_REFUSED(lahar_world_set_progress, world, (NULL, go_on, NULL, 0.1));
  NULL_ALLOWED(lahar_world_set_progress, user, (world, go_on, NULL, 0.1));
  OK(lahar_world_set_progress(world, NULL, NULL, 0.1));
  NULL_REFUSED(lahar_world_settle, world, (NULL, &criteria, &result));
  NULL_ALLOWED(lahar_world_settle, result, (world, &criteria, NULL));
  NULL_REFUSED(lahar_body_set_k0_stress, world, (NULL, 0, 1, 0, 0.5));
  NULL_REFUSED(lahar_body_init_state, world, (NULL, 0));
  OK(lahar_world_set_damping(world, 0.7));
  NULL_ALLOWED(lahar_world_settle, criteria, (world, NULL, &result));
  CHECK(result.converged == 1);
}

/* The path of the elastic plugin. */
int main(int argc, char **argv) {
  if (argc < 2) return 2;
  OK(lahar_context_create(1, &context));
  NULL_ALLOWED(lahar_context_load_plugin, plugin, (context, argv[1], NULL));
  material = make_elastic(context);
  world = make_world(context);
  if (failures) return 1;
  add_block(world, material, 1000);
  context_functions();
  model_functions();
  world_functions();
  body_functions();
  field_functions();
  wall_and_grid_functions();
  condition_functions();
  /* Freed in the wrong order on purpose: children keep parents alive. */
  lahar_context_free(context);
  lahar_material_free(material);
  OK(lahar_world_step_auto(world, NULL));
  lahar_world_free(world);
  return failures != 0;
}
