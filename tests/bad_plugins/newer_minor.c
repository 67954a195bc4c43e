/* Nothing wrong: tables of a later minor are longer, and the model says that it works with any engine. */
#include "minimal.h"

struct {
  lahar_plugin_desc known;
  void *later;
} longer_plugin;
struct {
  lahar_model_desc known;
  void *later;
} longer_model;
struct later_parameter {
  lahar_parameter_desc known;
  double later;
} longer_parameters[2];

static void spoil(void) {
  longer_parameters[0].known = parameters[0];
  longer_parameters[1].known = parameters[1];
  model.parameters = &longer_parameters[0].known;
  model.parameter_size = sizeof longer_parameters[0];
  model.struct_size = sizeof longer_model;
  longer_model.known = model;
  models[0] = &longer_model.known;
  plugin.struct_size = sizeof longer_plugin;
  plugin.abi_minor = 7;
}
