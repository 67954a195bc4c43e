/* A host that asks for capsules, and one that does not. Arguments: the plugin failing_model, a folder. */
#include "check.h"

/* A world whose particle 7 fails in the third step, and the message of that. */
static void fail(lahar_context *context, char *text, int64_t capacity) {
  lahar_material *bad = NULL;
  lahar_world *world = make_world(context);
  double memory[400] = {0};
  int64_t body, n = 0, done = -1;
  OK(lahar_material_create(context, "failing_model", 0, NULL, NULL, &bad));
  body = add_block(world, bad, 1e4);
  OK(lahar_body_particle_count(world, body, &n));
  CHECK(n == 400);
  memory[7] = 3;
  OK(lahar_body_write(world, body, "memory", n, memory, 0, 0));
  EXPECT(lahar_world_advance(world, 1.0, 10, &done, NULL), LAHAR_ERROR_MATERIAL_FAILED, "particle 7 of body 0");
  CHECK(done == 2);
  OK(lahar_last_error_message(text, capacity, NULL));
  lahar_world_free(world);
  lahar_material_free(bad);
}

int main(int argc, char **argv) {
  const char *plugins[] = {NULL, NULL};
  lahar_context *context;
  char text[4096];
  if (argc != 3) return 2;
  plugins[0] = argv[1];
  context = make_context(plugins);
  fail(context, text, sizeof text);
  CHECK(strstr(text, "kept in") == NULL);
  OK(lahar_context_set_capsule_folder(context, argv[2]));
  EXPECT(lahar_context_set_capsule_folder(context, "/nowhere/at/all"), LAHAR_ERROR_FILE, "`/nowhere/at/all`");
  fail(context, text, sizeof text); /* the folder is what it was */
  CHECK(strstr(text, "lahar-capsule-failing_model-0-7-2.json") != NULL);
  OK(lahar_context_set_capsule_folder(context, ""));
  fail(context, text, sizeof text);
  CHECK(strstr(text, "kept in") == NULL);
  OK(lahar_context_set_capsule_folder(context, argv[2]));
  OK(lahar_context_set_capsule_folder(context, NULL));
  fail(context, text, sizeof text);
  CHECK(strstr(text, "kept in") == NULL);
  lahar_context_free(context);
  return failures != 0;
}
