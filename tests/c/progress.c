/* Progress and cancellation: the host is called between steps, may ask the world but not change it, and may cancel. Results do
 * not depend on it. The elastic plugin is found by LAHAR_PLUGIN_PATH. */
#include "check.h"

#include <signal.h>
#include <time.h>
#include <unistd.h>

typedef struct {
  lahar_world *world;
  int64_t calls, cancel_at, last_steps;
  lahar_view *view;
  int is_signal_wanted;
} watch;

static volatile sig_atomic_t interrupted = 0;

static void on_signal(int number) {
  (void)number;
  interrupted = 1;
}

static int32_t progress(int64_t steps_done, double time, void *user) {
  watch *w = user;
  lahar_view *refused = NULL;
  double now = -1, x[2] = {0.5, 0.5}, v[2];
  int64_t steps = -1;
  lahar_totals totals = {0};
  totals.struct_size = sizeof totals;
  ++w->calls;
  CHECK(steps_done > w->last_steps);
  w->last_steps = steps_done;
  /* queries are answered */
  OK(lahar_world_time(w->world, &now));
  CHECK(now == time);
  OK(lahar_world_step_count(w->world, &steps));
  CHECK(steps >= steps_done);
  OK(lahar_world_totals(w->world, LAHAR_ALL_BODIES, &totals));
  OK(lahar_grid_sample(w->world, "velocity", 1, x, v, NULL));
  /* changes are not */
  EXPECT(lahar_world_step_auto(w->world, NULL), LAHAR_ERROR_BUSY, "the call that this callback belongs to");
  EXPECT(lahar_world_set_damping(w->world, 0.1), LAHAR_ERROR_BUSY, "");
  EXPECT(lahar_body_view(w->world, 0, "velocity", LAHAR_ACCESS_WRITE, &refused), LAHAR_ERROR_BUSY, "");
  if (w->calls == 1) OK(lahar_body_view(w->world, 0, "velocity", LAHAR_ACCESS_READ, &w->view));
  if (w->is_signal_wanted) return interrupted;
  return w->cancel_at && w->calls >= w->cancel_at ? 7 : 0;
}

static lahar_world *make_block(lahar_context *context, const lahar_material *material) {
  lahar_world *world = make_world(context);
  add_block(world, material, 1000);
  OK(lahar_world_set_damping(world, 0.5));
  return world;
}

static void compare(lahar_world *a, lahar_world *b) {
  const picture pa = take_picture(a), pb = take_picture(b);
  CHECK(memcmp(&pa, &pb, sizeof pa) == 0);
}

static lahar_view_info info_of(lahar_view *view, lahar_status wanted) {
  lahar_view_info info = {0};
  info.struct_size = sizeof info;
  EXPECT(lahar_view_data(view, &info), wanted, "");
  return info;
}

static void advances(lahar_context *context, const lahar_material *material) {
  lahar_world *plain = make_block(context, material), *watched = make_block(context, material);
  watch w = {watched, 0, 5, 0, NULL, 0};
  int64_t steps = -1;
  double time = -1;
  OK(lahar_world_advance(plain, 1e9, 40, NULL, NULL));
  OK(lahar_world_set_progress(watched, progress, &w, 0));
  EXPECT(lahar_world_advance(watched, 1e9, 40, &steps, &time), LAHAR_ERROR_CANCELLED, "returned 7: stopped after 5 steps");
  CHECK(steps == 5 && w.calls == 5 && time > 0);
  info_of(w.view, LAHAR_ERROR_VIEW_STALE); /* opened in a callback, and steps came after */
  lahar_view_free(w.view);
  w.cancel_at = 0;
  w.last_steps = 0;
  OK(lahar_world_advance(watched, 1e9, 35, &steps, NULL));
  CHECK(steps == 35 && w.calls == 5 + 34); /* not after the last step */
  compare(plain, watched);
  /* nobody is called any more, or seldom */
  OK(lahar_world_set_progress(watched, NULL, NULL, 0));
  OK(lahar_world_advance(watched, 1e9, 10, NULL, NULL));
  OK(lahar_world_set_progress(watched, progress, &w, 3600));
  OK(lahar_world_advance(watched, 1e9, 10, NULL, NULL));
  CHECK(w.calls == 5 + 34);
  EXPECT(lahar_world_set_progress(watched, progress, &w, -1), LAHAR_ERROR_INVALID_ARGUMENT, "must be finite and >= 0 [s], got -1");
  EXPECT(lahar_world_set_progress(watched, progress, &w, NAN), LAHAR_ERROR_INVALID_ARGUMENT, "got NaN");
  EXPECT(lahar_world_set_progress(watched, progress, &w, INFINITY), LAHAR_ERROR_INVALID_ARGUMENT, "got inf");
  EXPECT(lahar_world_set_progress(NULL, progress, &w, 0), LAHAR_ERROR_NULL_ARGUMENT, "world");
  lahar_world_free(plain);
  lahar_world_free(watched);
}

static void settles(lahar_context *context, const lahar_material *material) {
  lahar_world *plain = make_block(context, material), *watched = make_block(context, material);
  watch w = {watched, 0, 70, 0, NULL, 0};
  lahar_settle_result a = {0}, b = {0};
  a.struct_size = b.struct_size = sizeof a;
  OK(lahar_world_settle(plain, NULL, &a));
  OK(lahar_world_set_progress(watched, progress, &w, 0));
  EXPECT(lahar_world_settle(watched, NULL, &b), LAHAR_ERROR_CANCELLED, "stopped after");
  CHECK(b.steps >= 70 && b.steps < 80 && !b.converged);
  lahar_view_free(w.view);
  lahar_world_free(watched);
  /* without a cancel the checks are at the same steps */
  watched = make_block(context, material);
  w.world = watched;
  w.cancel_at = w.last_steps = w.calls = 0;
  OK(lahar_world_set_progress(watched, progress, &w, 0));
  OK(lahar_world_settle(watched, NULL, &b));
  CHECK(a.converged && b.converged && a.steps == b.steps && a.time == b.time && a.unbalanced_ratio == b.unbalanced_ratio);
  lahar_view_free(w.view);
  compare(plain, watched);
  lahar_world_free(plain);
  lahar_world_free(watched);
}

/* What Ctrl-C does: a long run ends within the interval and a step, here with much to spare. */
static void interrupts(lahar_context *context, const lahar_material *material) {
  lahar_world *world = make_block(context, material);
  watch w = {world, 0, 0, 0, NULL, 1};
  struct timespec start, end;
  signal(SIGALRM, on_signal);
  OK(lahar_world_set_progress(world, progress, &w, 0.01));
  alarm(1);
  clock_gettime(CLOCK_MONOTONIC, &start);
  EXPECT(lahar_world_advance(world, 1e9, INT64_MAX, NULL, NULL), LAHAR_ERROR_CANCELLED, "the world can go on");
  clock_gettime(CLOCK_MONOTONIC, &end);
  CHECK(end.tv_sec - start.tv_sec < 20);
  CHECK(w.calls < 2100); /* a hundred a second at most, for as long as it may take */
  lahar_view_free(w.view);
  OK(lahar_world_set_progress(world, NULL, NULL, 0));
  OK(lahar_world_advance(world, 1e9, 3, NULL, NULL));
  lahar_world_free(world);
}

int main(void) {
  const char *const plugins[] = {"lahar_linear_elastic", NULL};
  lahar_context *context = make_context(plugins);
  lahar_material *material = make_elastic(context);
  advances(context, material);
  settles(context, material);
  interrupts(context, material);
  lahar_material_free(material);
  lahar_context_free(context);
  return failures;
}
