/* What a host may rely on: its floating-point environment, its log callback, and handles that are freed in any order.
 * Argument: the elastic plugin. */
#include "check.h"

#include <fenv.h>
#include <sys/wait.h>
#include <unistd.h>

static int lines = 0;
static char last_line[500];
static lahar_context *logged;

/* The host traps and rounds upwards, in its callbacks too, and may ask lahar from there. */
static void on_log(int32_t level, const char *message, void *user) {
  int32_t threads = 0;
  CHECK(fegetexcept() == (FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW));
  CHECK(fegetround() == FE_UPWARD);
  CHECK(user == &lines);
  CHECK(level == LAHAR_LOG_WARNING);
  OK(lahar_context_thread_count(logged, &threads));
  CHECK(threads == 2);
  ++lines;
  snprintf(last_line, sizeof last_line, "%s", message);
}

/* A fall onto the floor with two threads and many particles, so that the workers run. */
static picture fall(const char *plugin, int is_trapping) {
  const char *names[] = {"youngs_modulus", "poissons_ratio"};
  const double values[] = {1e6, 0.497}; /* beyond the advised bound: a warning */
  const double min[3] = {0, 0, 0}, max[3] = {10, 5, 0};
  lahar_world_options options;
  lahar_material *material = NULL;
  lahar_world *world = NULL;
  lahar_fill fill;
  lahar_wall floor;
  int64_t body = -1;
  int i;
  picture result;
  OK(lahar_context_create(2, &logged));
  OK(lahar_context_load_plugin(logged, plugin, NULL));
  CHECK(lahar_context_simd(NULL) == NULL);
  CHECK(strcmp(lahar_context_simd(logged), "scalar") == 0 || strcmp(lahar_context_simd(logged), "avx2") == 0 ||
        strcmp(lahar_context_simd(logged), "avx512") == 0);
  if (is_trapping) OK(lahar_context_set_log(logged, on_log, &lines, LAHAR_LOG_WARNING));
  OK(lahar_material_create(logged, "linear_elastic", 2, names, values, &material));
  OK(lahar_world_options_init(&options, sizeof options));
  options.dimension = 2;
  options.spacing = 0.1;
  options.gravity[1] = -9.81;
  OK(lahar_world_create(logged, &options, &world));
  OK(lahar_wall_init(&floor, sizeof floor));
  floor.axis = 1;
  OK(lahar_wall_add(world, &floor, NULL));
  OK(lahar_fill_init(&fill, sizeof fill));
  fill.density = 1000;
  OK(lahar_body_add_box(world, material, min, max, &fill, &body));
  for (i = 0; i < 20; ++i) OK(lahar_world_step_auto(world, NULL));
  result = take_picture(world);
  lahar_context_free(logged);
  lahar_world_free(world);
  lahar_material_free(material);
  return result;
}

static void floating_point(const char *plugin) {
  picture plain = fall(plugin, 0), trapped;
  feenableexcept(FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW);
  fesetround(FE_UPWARD);
  trapped = fall(plugin, 1);
  CHECK(fegetexcept() == (FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW));
  CHECK(fegetround() == FE_UPWARD);
  fedisableexcept(FE_ALL_EXCEPT);
  fesetround(FE_TONEAREST);
  CHECK(memcmp(&plain, &trapped, sizeof plain) == 0);
  CHECK(lines == 1 && strstr(last_line, "poissons_ratio") && strstr(last_line, "advised"));
}

static void freed_in_any_order(const char *plugin) {
  lahar_context *context = make_context((const char *const[]){plugin, NULL});
  lahar_material *material = make_elastic(context);
  lahar_world *world = make_world(context);
  lahar_view *view = NULL;
  lahar_view_info info = {0};
  int64_t body = add_block(world, material, 1000);
  double sum = 0;
  int64_t k;
  OK(lahar_world_step_auto(world, NULL));
  OK(lahar_body_view(world, body, "mass", LAHAR_ACCESS_READ, &view));
  lahar_context_free(context);
  lahar_material_free(material);
  lahar_world_free(world);
  info.struct_size = sizeof info;
  OK(lahar_view_data(view, &info)); /* the view keeps the world, the world the rest */
  CHECK(info.count == 400 && info.components == 1);
  for (k = 0; k < info.count; ++k) sum += info.data[k];
  CHECK(fabs(sum - 1000) < 1e-9);
  lahar_view_free(view);
}

/* Views and ids are in storage order, copies in the order of ids, with any strides. */
static void views_and_copies_agree(const char *plugin) {
  lahar_context *context = make_context((const char *const[]){plugin, NULL});
  lahar_material *material = make_elastic(context);
  lahar_world *world = make_world(context);
  lahar_view *view = NULL;
  lahar_view_info info = {0};
  int64_t body = add_block(world, material, 1000), ids[400], count = 0, k;
  double interleaved[800], columns[800];
  OK(lahar_world_step_auto(world, NULL));
  OK(lahar_body_read(world, body, "position", 400, interleaved, 0, 0));
  OK(lahar_body_read(world, body, "position", 400, columns, 400, 1));
  OK(lahar_body_ids(world, body, 400, ids, &count));
  OK(lahar_body_view(world, body, "position", LAHAR_ACCESS_READ, &view));
  info.struct_size = sizeof info;
  OK(lahar_view_data(view, &info));
  CHECK(count == 400 && info.count == 400 && info.components == 2);
  for (k = 0; k < 400; ++k) {
    CHECK(info.data[k] == interleaved[2 * ids[k]] && info.data[info.stride + k] == interleaved[2 * ids[k] + 1]);
    CHECK(columns[k] == interleaved[2 * k] && columns[400 + k] == interleaved[2 * k + 1]);
  }
  lahar_view_free(view);
  for (k = 0; k < 400; ++k) columns[k] += 10;
  OK(lahar_body_write(world, body, "position", 400, columns, 400, 1));
  OK(lahar_body_read(world, body, "position", 400, columns, 0, 0));
  for (k = 0; k < 400; ++k) CHECK(columns[2 * k] == interleaved[2 * k] + 10);
  OK(lahar_world_step_auto(world, NULL));
  lahar_world_free(world);
  lahar_material_free(material);
  lahar_context_free(context);
}

/* The threads of a context stay in the parent: the child is told so instead of waiting for ever. */
static void after_a_fork(const char *plugin) {
  lahar_context *context = NULL;
  lahar_material *material;
  lahar_world *world;
  int status = -1;
  pid_t child;
  OK(lahar_context_create(2, &context));
  OK(lahar_context_load_plugin(context, plugin, NULL));
  material = make_elastic(context);
  world = make_world(context);
  add_block(world, material, 1000);
  OK(lahar_world_step_auto(world, NULL));
  fflush(NULL);
  child = fork();
  if (child == 0) {
    failures = 0;
    EXPECT(lahar_world_step_auto(world, NULL), LAHAR_ERROR_THREADS, "fork");
    lahar_world_free(world);
    lahar_material_free(material);
    lahar_context_free(context);
    _exit(failures);
  }
  CHECK(waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0);
  OK(lahar_world_step_auto(world, NULL));
  lahar_world_free(world);
  lahar_material_free(material);
  lahar_context_free(context);
}

int main(int argc, char **argv) {
  if (argc < 2) return 2;
  floating_point(argv[1]);
  freed_in_any_order(argv[1]);
  views_and_copies_agree(argv[1]);
  after_a_fork(argv[1]);
  return failures != 0;
}
