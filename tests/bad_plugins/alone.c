/* Nothing wrong: a model that is not thread-safe, and counts the calls that found another one running. */
#include "minimal.h"

#include <stdio.h>

static int inside, overlaps;

static void run_alone(void) {
  volatile int i;
  if (__atomic_add_fetch(&inside, 1, __ATOMIC_SEQ_CST) != 1) __atomic_add_fetch(&overlaps, 1, __ATOMIC_SEQ_CST);
  for (i = 0; i < 20000; ++i) {}
  __atomic_sub_fetch(&inside, 1, __ATOMIC_SEQ_CST);
}

static int32_t check_alone(const lahar_model_desc *table, const double *values, int64_t count, char *message,
                           int64_t capacity) {
  (void)table;
  (void)values;
  (void)count;
  run_alone();
  if (__atomic_load_n(&overlaps, __ATOMIC_SEQ_CST) == 0) return LAHAR_PLUGIN_OK;
  snprintf(message, (size_t)capacity, "%d calls overlapped", overlaps);
  return LAHAR_PLUGIN_ERROR;
}

static int32_t create_alone(const lahar_model_desc *table, const double *values, int64_t count, void **instance) {
  run_alone();
  return create(table, values, count, instance);
}

static void destroy_alone(void *instance) {
  run_alone();
  destroy(instance);
}

static int32_t update_alone(const void *instance, const lahar_stress_batch *b) {
  run_alone();
  return update(instance, b);
}

static void spoil(void) {
  model.check = check_alone;
  model.create = create_alone;
  model.destroy = destroy_alone;
  model.update = update_alone;
  model.capabilities = 0;
}
