/* lahar_plugin.hpp: constitutive models for lahar in C++17. Header only; it fills the tables of lahar_plugin.h.
 *
 * A model is a class with
 *
 *   static constexpr const char *name, *summary, *reference;
 *   static constexpr std::int32_t kinematics;                       one of LAHAR_KINEMATICS_*
 *   static constexpr auto parameters = lahar::parameters(...);      lahar::real(...), lahar::integer(...), lahar::choice(...)
 *   static constexpr auto states = lahar::states(...);              lahar::scalar(...), lahar::symmetric(...), lahar::tensor(...)
 *   static constexpr auto inputs = lahar::inputs(...);              LAHAR_INPUT_*
 *   static constexpr std::uint64_t outputs, capabilities;           sums of LAHAR_OUTPUT_*, LAHAR_CAPABILITY_*
 *
 *   explicit Model(const double *values);                           the parameters in order; throws if they do not go together
 *   void update(const lahar::Start<Model> &, lahar::End<Model> &) const;       one step of one point
 *   void wave_speed(const lahar::Start<Model> &, lahar::End<Model> &) const;   sets end.wave_speed (and end.diffusivity)
 *   void init_state(const lahar::Start<Model> &, lahar::End<Model> &) const;   if the first state follows from the stress
 *
 * Instead of `update` for one point a model may have `void update(const lahar_stress_batch &) const` for a batch.
 * LAHAR_PLUGIN(id, version, author, licence, Models...) writes the entry.
 *
 * An exception does not leave the plugin: the function that threw returns LAHAR_PLUGIN_ERROR, and the host is told what().
 * Mistakes in the tables that the compiler can see do not compile.
 */

#ifndef LAHAR_PLUGIN_HPP
#define LAHAR_PLUGIN_HPP

#include <lahar/lahar_plugin.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <exception>
#include <limits>
#include <memory>
#include <type_traits>
#include <utility>

/* Hidden: two plugins with classes of one name do not meet. */
namespace lahar __attribute__((visibility("hidden"))) {

/* ---- tables */

struct Parameter : lahar_parameter_desc {
    /* Not required: the value that is taken if the host gives none. */
    constexpr Parameter by_default(double value) const {
        Parameter p = *this;
        p.required = 0;
        p.default_value = value;
        return p;
    }
    /* Still required: a typical value, with which tools try the model. */
    constexpr Parameter typical(double value) const {
        Parameter p = *this;
        p.default_value = value;
        return p;
    }
    /* Values outside are refused. */
    constexpr Parameter hard(double min, double max) const {
        Parameter p = *this;
        p.hard_min = min;
        p.hard_max = max;
        return p;
    }
    /* Values outside are warned of. */
    constexpr Parameter advised(double min, double max) const {
        Parameter p = *this;
        p.advised_min = min;
        p.advised_max = max;
        return p;
    }
};

/* The smallest positive number, as a bound for what must not be zero, and none. */
constexpr double positive = std::numeric_limits<double>::min();
constexpr double infinity = std::numeric_limits<double>::infinity();

/* A required real number. */
constexpr Parameter real(const char *key, const char *symbol, const char *unit, const char *description) {
    return {{key, symbol, unit, description, LAHAR_PARAMETER_REAL, 1, 0.0, -infinity, infinity, -infinity, infinity, nullptr}};
}

/* A required whole number. */
constexpr Parameter integer(const char *key, const char *symbol, const char *unit, const char *description) {
    return {{key, symbol, unit, description, LAHAR_PARAMETER_INTEGER, 1, 0.0, -infinity, infinity, -infinity, infinity, nullptr}};
}

/* One of the labels "first|second|...", counted from 0; `value` is the default. */
constexpr Parameter choice(const char *key, const char *labels, int value, const char *description) {
    double last = 0.0;
    for (const char *c = labels; *c != '\0'; ++c) last += *c == '|' ? 1.0 : 0.0;
    return {{key, "", "-", description, LAHAR_PARAMETER_CHOICE, 0, double(value), 0.0, last, -infinity, infinity, labels}};
}

constexpr lahar_state_desc scalar(const char *key, const char *unit, const char *description, double initial = 0.0) {
    return {key, unit, description, LAHAR_STATE_SCALAR, LAHAR_ROTATION_NONE, initial};
}

/* Six components, which the engine turns with the material. */
constexpr lahar_state_desc symmetric(const char *key, const char *unit, const char *description, double initial = 0.0) {
    return {key, unit, description, LAHAR_STATE_SYMMETRIC, LAHAR_ROTATION_OBJECTIVE, initial};
}

/* Nine components, row by row, which the engine leaves alone. */
constexpr lahar_state_desc tensor(const char *key, const char *unit, const char *description, double initial = 0.0) {
    return {key, unit, description, LAHAR_STATE_TENSOR, LAHAR_ROTATION_NONE, initial};
}

template <class... P> constexpr std::array<lahar_parameter_desc, sizeof...(P)> parameters(const P &...p) { return {{p...}}; }
template <class... S> constexpr std::array<lahar_state_desc, sizeof...(S)> states(const S &...s) { return {{s...}}; }
template <class... I> constexpr std::array<std::int32_t, sizeof...(I)> inputs(I... i) { return {{i...}}; }

/* ---- points */

namespace detail {

template <std::size_t N> constexpr std::size_t components(const std::array<lahar_state_desc, N> &states) {
    std::size_t sum = 0;
    for (const lahar_state_desc &s : states)
        sum += s.kind == LAHAR_STATE_SCALAR ? 1 : s.kind == LAHAR_STATE_VECTOR ? 3 : s.kind == LAHAR_STATE_SYMMETRIC ? 6 : 9;
    return sum;
}

} // namespace detail

/* A point before the step. What the kinematics do not ask for is zero. */
template <class Model> struct Start {
    double dt = 0.0;             /* length of the step [s] */
    double time = 0.0;           /* at its start [s] */
    std::int64_t step = -1;      /* number of steps before this one; -1 if there is no such count */
    std::array<double, 6> strain_increment{};
    std::array<double, 9> gradient{}; /* velocity gradient [1/s] or deformation gradient at the end [-], row by row */
    std::array<double, 6> stress{};   /* [Pa] */
    std::array<double, detail::components(Model::states)> state{};
    std::array<double, Model::inputs.size()> inputs{};
};

/* A point after the step. Stress and state arrive as they were at its start. */
template <class Model> struct End {
    std::array<double, 6> stress{};
    std::array<double, detail::components(Model::states)> state{};
    double wave_speed = std::numeric_limits<double>::quiet_NaN(); /* [m/s] */
    double diffusivity = 0.0;                                     /* [m^2/s] */
    double energy = 0.0;                                          /* [J/m^3] */
    double dt_factor = 1.0;
    std::int32_t status = LAHAR_POINT_OK;
};

/* ---- the wall between C and the models */

namespace detail {

inline const lahar_host_api *host = nullptr;

inline void set_error(const char *text) noexcept {
    if (host != nullptr && host->set_error != nullptr) host->set_error(text);
}

/* Runs `body`; an exception goes to `report` as a text. */
template <class Body, class Report> std::int32_t guard(Body body, Report report) noexcept {
    try {
        body();
        return LAHAR_PLUGIN_OK;
    } catch (const std::exception &e) {
        report(e.what());
    } catch (...) {
        report("an exception that is no std::exception");
    }
    return LAHAR_PLUGIN_ERROR;
}

template <std::size_t N> void read(const double *base, std::int64_t stride, std::int64_t k, std::array<double, N> &values) {
    if (base == nullptr) return;
    for (std::size_t c = 0; c < N; ++c) values[c] = base[std::int64_t(c) * stride + k];
}

template <std::size_t N> void write(double *base, std::int64_t stride, std::int64_t k, const std::array<double, N> &values) {
    for (std::size_t c = 0; c < N; ++c) base[std::int64_t(c) * stride + k] = values[c];
}

template <class T> void write(T *base, std::int64_t k, T value) {
    if (base != nullptr) base[k] = value;
}

template <class Model> void read(const lahar_stress_batch &b, std::int64_t k, Start<Model> &start) {
    read(b.strain_increment, b.stride, k, start.strain_increment);
    read(Model::kinematics == LAHAR_KINEMATICS_VELOCITY_GRADIENT ? b.velocity_gradient : b.deformation_gradient, b.stride, k,
         start.gradient);
    read(b.stress0, b.stride, k, start.stress);
    read(b.state0, b.stride, k, start.state);
    for (std::size_t i = 0; i < start.inputs.size(); ++i) start.inputs[i] = b.inputs[i][k];
}

template <class Model, class = void> struct updates_batches : std::false_type {};
template <class Model>
struct updates_batches<
    Model, std::void_t<decltype(std::declval<const Model &>().update(std::declval<const lahar_stress_batch &>()))>>
    : std::true_type {};

template <class Model, class = void> struct has_init_state : std::false_type {};
template <class Model>
struct has_init_state<Model, std::void_t<decltype(std::declval<const Model &>().init_state(
                                 std::declval<const Start<Model> &>(), std::declval<End<Model> &>()))>> : std::true_type {};

/* The functions of the table of one model. */
template <class Model> struct Functions {
    static std::int32_t create(const lahar_model_desc *, const double *values, std::int64_t, void **instance) noexcept {
        *instance = nullptr;
        return guard([&] { *instance = std::make_unique<Model>(values).release(); }, set_error);
    }

    static void destroy(void *instance) noexcept { delete static_cast<Model *>(instance); }

    static std::int32_t check(const lahar_model_desc *, const double *values, std::int64_t, char *message, std::int64_t capacity) noexcept {
        return guard([&] { Model trial(values); },
                     [&](const char *text) {
                         if (message == nullptr || capacity < 1) return;
                         std::strncpy(message, text, std::size_t(capacity) - 1);
                         message[capacity - 1] = '\0';
                     });
    }

    static std::int32_t init_state(const void *instance, const lahar_stress_batch *b) noexcept {
        return guard([&] { each(*b, [&](Start<Model> &start, End<Model> &end, std::int64_t k) {
                         read(b->state1, b->stride, k, end.state);
                         static_cast<const Model *>(instance)->init_state(start, end);
                         write(b->state1, b->stride, k, end.state);
                     }); }, set_error);
    }

    static std::int32_t update(const void *instance, const lahar_stress_batch *b) noexcept {
        const Model &model = *static_cast<const Model *>(instance);
        return guard([&] {
            if constexpr (updates_batches<Model>::value) {
                model.update(*b);
            } else {
                each(*b, [&](Start<Model> &start, End<Model> &end, std::int64_t k) {
                    model.update(start, end);
                    write(b->stress1, b->stride, k, end.stress);
                    write(b->state1, b->stride, k, end.state);
                    write(b->wave_speed, k, end.wave_speed);
                    write(b->diffusivity, k, end.diffusivity);
                    write(b->energy, k, end.energy);
                    write(b->dt_factor, k, end.dt_factor);
                    write(b->status, k, end.status);
                });
            }
        }, set_error);
    }

    static std::int32_t wave_speed(const void *instance, const lahar_stress_batch *b) noexcept {
        return guard([&] { each(*b, [&](Start<Model> &start, End<Model> &end, std::int64_t k) {
                         static_cast<const Model *>(instance)->wave_speed(start, end);
                         write(b->wave_speed, k, end.wave_speed);
                         write(b->diffusivity, k, end.diffusivity);
                     }); }, set_error);
    }

private:
    template <class Body> static void each(const lahar_stress_batch &b, Body body) {
        for (std::int64_t k = 0; k < b.n; ++k) {
            Start<Model> start;
            start.dt = b.dt;
            start.time = b.time;
            start.step = b.step;
            read(b, k, start);
            End<Model> end;
            end.stress = start.stress;
            end.state = start.state;
            body(start, end, k);
        }
    }
};

/* ---- what the compiler sees */

constexpr bool is_name(const char *text) {
    if (*text == '\0' || (*text >= '0' && *text <= '9')) return false;
    for (; *text != '\0'; ++text)
        if (!((*text >= 'a' && *text <= 'z') || (*text >= 'A' && *text <= 'Z') || (*text >= '0' && *text <= '9') || *text == '_'))
            return false;
    return true;
}

constexpr bool equal(const char *a, const char *b) {
    for (; *a != '\0' && *a == *b; ++a) ++b;
    return *a == *b;
}

template <class Table> constexpr bool has_good_keys(const Table &table) {
    for (std::size_t i = 0; i < table.size(); ++i) {
        if (!is_name(table[i].key)) return false;
        for (std::size_t j = 0; j < i; ++j)
            if (equal(table[i].key, table[j].key)) return false;
    }
    return true;
}

template <std::size_t N> constexpr bool has_values_in_bounds(const std::array<lahar_parameter_desc, N> &table) {
    for (const lahar_parameter_desc &p : table)
        if (!(p.hard_min <= p.default_value && p.default_value <= p.hard_max && p.advised_min <= p.advised_max)) return false;
    return true;
}

template <class Model> struct Table {
    static_assert(is_name(Model::name), "name: letters, digits and _, not a digit first");
    static_assert(has_good_keys(Model::parameters), "parameters: each key is a name, and no two are equal");
    static_assert(has_good_keys(Model::states), "states: each key is a name, and no two are equal");
    static_assert(has_values_in_bounds(Model::parameters), "parameters: a default or typical value is outside its bounds");
    static_assert((Model::outputs & LAHAR_OUTPUT_WAVE_SPEED) != 0, "outputs: LAHAR_OUTPUT_WAVE_SPEED is mandatory");
    static_assert(std::is_constructible_v<Model, const double *>, "the model needs a constructor from const double *values");

    static constexpr lahar_model_desc desc = {
        sizeof(lahar_model_desc),
        Model::kinematics,
        Model::name,
        Model::summary,
        Model::reference,
        std::uint32_t(Model::parameters.size()),
        sizeof(lahar_parameter_desc),
        Model::parameters.data(),
        std::uint32_t(Model::states.size()),
        sizeof(lahar_state_desc),
        Model::states.data(),
        std::uint32_t(Model::inputs.size()),
        0,
        Model::inputs.data(),
        Model::outputs,
        Model::capabilities,
        Functions<Model>::create,
        Functions<Model>::destroy,
        Functions<Model>::check,
        [] { if constexpr (has_init_state<Model>::value) return Functions<Model>::init_state; else return nullptr; }(),
        Functions<Model>::update,
        Functions<Model>::wave_speed,
        nullptr,
    };
};

template <class... Models> inline constexpr const lahar_model_desc *tables[] = {&Table<Models>::desc...};

} // namespace detail
} // namespace lahar

/* Writes the entry of a plugin. The texts are literals; models follow. */
#define LAHAR_PLUGIN(id, version, author, licence, ...)                                                              \
    extern "C" LAHAR_PLUGIN_EXPORT const lahar_plugin_desc *lahar_plugin_entry_v1(const lahar_host_api *host) {        \
        static constexpr lahar_plugin_desc plugin = {                                                                  \
            sizeof(lahar_plugin_desc), LAHAR_PLUGIN_ABI_MAJOR, LAHAR_PLUGIN_ABI_MINOR,                                 \
            std::size(lahar::detail::tables<__VA_ARGS__>), id, version, author, licence, "",                           \
            lahar::detail::tables<__VA_ARGS__>};                                                                       \
        lahar::detail::host = host;                                                                                    \
        return &plugin;                                                                                                \
    }

#endif
