/* The template's model, compiled into the program: registered by its entry, then a block of it falls onto a floor. */
#include "check.h"

#include "lahar/lahar_plugin.h"

int main(void) {
  const char *names[] = {"youngs_modulus", "poissons_ratio", "yield_stress"};
  const double values[] = {1e6, 0.3, 1e3};
  lahar_context *context = NULL;
  lahar_material *material = NULL;
  lahar_world *world;
  int64_t index = -1, again = -1, body, n = 0, k;
  double *strain, sum = 0.0;
  OK(lahar_context_create(1, &context));
  OK(lahar_context_register_plugin(context, lahar_plugin_entry_v1, &index));
  OK(lahar_context_register_plugin(context, lahar_plugin_entry_v1, &again));
  OK(lahar_material_create(context, "own_material", 3, names, values, &material));
  world = make_world(context);
  body = add_block(world, material, 1600.0);
  OK(lahar_world_advance(world, 0.2, 10000, NULL, NULL));
  OK(lahar_body_particle_count(world, body, &n));
  strain = malloc((size_t)n * sizeof *strain);
  if (strain == NULL) return 1;
  OK(lahar_body_read(world, body, "equivalent_plastic_strain", n, strain, 0, 0));
  for (k = 0; k < n; ++k) sum += strain[k];
  printf("%d\n%d\n%.17g\n", (int)index, (int)again, sum);
  free(strain);
  lahar_world_free(world);
  lahar_material_free(material);
  lahar_context_free(context);
  return failures;
}
