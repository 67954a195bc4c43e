/* own_material.cpp: a constitutive model for lahar in C++17, to be copied and changed.
 *
 * Isotropic linear elasticity with a von Mises cap: perfect plasticity, radial return. From the folder that holds include/:
 *
 *   c++ -std=c++17 -O2 -fPIC -shared -Wl,-Bsymbolic -Wl,--version-script=include/lahar/lahar_plugin.map -Iinclude own_material.cpp -o libown_material.so
 *
 * Change what stands under the comments CHANGE. lahar_plugin.hpp tells what a model has; in short: units are those of the host,
 * tension is positive, stresses and strains have the tensor components xx, yy, zz, xy, yz, zx in plane strain too, and a function
 * neither prints nor exits. It may throw.
 */

#include <cmath>
#include <lahar/lahar_plugin.hpp>
#include <stdexcept>

class OwnMaterial {
public:
    /* CHANGE names, kinematics, parameters, state variables, inputs and outputs. A typical value of a required parameter is one with
     * which tools try the model. Values outside the hard bounds are refused, those outside the advised ones are warned of. */
    static constexpr const char *name = "own_material";
    static constexpr const char *summary = "Linear elasticity with a von Mises cap";
    static constexpr const char *reference = "Simo, Hughes: Computational Inelasticity (1998), section 3.3, doi:10.1007/b98904";
    static constexpr std::int32_t kinematics = LAHAR_KINEMATICS_STRAIN_INCREMENT;
    static constexpr auto parameters = lahar::parameters(
        lahar::real("youngs_modulus", "E", "Pa", "Young's modulus")
            .typical(1e7).hard(lahar::positive, lahar::infinity),
        lahar::real("poissons_ratio", "nu", "-", "Poisson's ratio")
            .typical(0.3).hard(-0.999, 0.4999).advised(0.0, 0.495),
        lahar::real("yield_stress", "Y", "Pa", "Largest von Mises stress")
            .typical(1e4).hard(lahar::positive, lahar::infinity));
    static constexpr auto states = lahar::states(
        lahar::scalar("equivalent_plastic_strain", "-", "Integral of the rate of plastic strain"));
    static constexpr auto inputs = lahar::inputs(LAHAR_INPUT_DENSITY);
    static constexpr std::uint64_t outputs = LAHAR_OUTPUT_WAVE_SPEED | LAHAR_OUTPUT_STATUS;
    /* True as long as the functions keep nothing between calls. */
    static constexpr std::uint64_t capabilities =
        LAHAR_CAPABILITY_THREAD_SAFE | LAHAR_CAPABILITY_POINTWISE | LAHAR_CAPABILITY_DETERMINISTIC;

    using Start = lahar::Start<OwnMaterial>;
    using End = lahar::End<OwnMaterial>;

    /* CHANGE how an instance is made. Values come in the order of `parameters`, inside their hard bounds. */
    explicit OwnMaterial(const double *values) {
        const double e = values[0], nu = values[1];
        shear_modulus = e / (2.0 * (1.0 + nu));
        lambda = e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu));
        yield_stress = values[2];
        if (!std::isfinite(lambda) || !std::isfinite(shear_modulus))
            throw std::invalid_argument("youngs_modulus gives moduli that are not finite");
    }

    /* CHANGE the law: one step of one point. The engine has turned the start stress with the material. */
    void update(const Start &start, End &end) const {
        const auto &strain = start.strain_increment;
        auto &stress = end.stress; /* holds the start stress */
        const double volumetric = lambda * (strain[0] + strain[1] + strain[2]), two_g = 2.0 * shear_modulus;
        /* the elastic trial */
        for (int c = 0; c < 3; ++c) stress[c] = stress[c] + volumetric + two_g * strain[c];
        for (int c = 3; c < 6; ++c) stress[c] = stress[c] + two_g * strain[c];
        /* its deviator and von Mises stress */
        const double mean = (stress[0] + stress[1] + stress[2]) / 3.0;
        auto s = stress;
        for (int c = 0; c < 3; ++c) s[c] -= mean;
        const double mises =
            std::sqrt(1.5 * (s[0] * s[0] + s[1] * s[1] + s[2] * s[2] + 2.0 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5])));
        /* what is beyond the cap goes back along the deviator */
        const double share = mises > yield_stress ? (mises - yield_stress) / mises : 0.0;
        for (int c = 0; c < 6; ++c) stress[c] -= share * s[c];
        end.state[0] = start.state[0] + share * mises / (3.0 * shear_modulus);
        wave_speed(start, end);
        bool sane = std::isfinite(end.wave_speed) && std::isfinite(end.state[0]);
        for (double component : stress) sane = sane && std::isfinite(component);
        if (!sane) end.status = LAHAR_POINT_FAILED;
    }

    /* CHANGE the speed of the fastest wave [m/s]: the time step follows from it, too low a speed makes the run unstable. */
    void wave_speed(const Start &start, End &end) const {
        const double density = start.inputs[0];
        end.wave_speed = std::sqrt((lambda + 2.0 * shear_modulus) / density);
    }

private:
    double lambda, shear_modulus, yield_stress; /* [Pa] */
};

/* CHANGE who and what; more models may follow. */
LAHAR_PLUGIN("org.example.own_material", "1.0", "You", "MIT OR Apache-2.0", OwnMaterial)
