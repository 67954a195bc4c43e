//! The loadable form of the model: nothing but the entry symbol.

lahar_plugin::export_plugin!(lahar_model_ideal_gas::PLUGIN);
