!> own_material.f90: a constitutive model for lahar in Fortran 2008, to be copied and changed.
!>
!> Isotropic linear elasticity with a von Mises cap: perfect plasticity, radial return. From the folder that holds include/:
!>
!>   gfortran -std=f2018 -O2 -fPIC -shared -Wl,-Bsymbolic -Wl,--version-script=include/lahar/lahar_plugin.map include/lahar/lahar_plugin.f90 own_material.f90 -o libown_material.so
!>
!> Change what stands under the comments CHANGE. In short: units are those of the host, tension is positive, stresses and strains have
!> the tensor components xx, yy, zz, xy, yz, zx in plane strain too. Never `stop`, `error stop` or `print`: they end or soil the
!> host's process. A point that cannot be updated gets the status LAHAR_POINT_FAILED.
module own_material
  use, intrinsic :: iso_c_binding
  use lahar_plugin
  implicit none
  private
  public :: lahar_plugin_entry_v1

contains

  ! CHANGE the constants of one instance, made once from the values of the parameters, which come in their order inside their hard
  ! bounds. A message refuses them.
  subroutine make_constants(values, constants, message)
    real(c_double), intent(in) :: values(:)
    real(c_double), allocatable, intent(out) :: constants(:)
    character(:), allocatable, intent(inout) :: message
    real(c_double) :: lambda, shear_modulus ! [Pa]
    associate (e => values(1), nu => values(2), yield_stress => values(3))
      shear_modulus = e / (2.0_c_double * (1.0_c_double + nu))
      lambda = e * nu / ((1.0_c_double + nu) * (1.0_c_double - 2.0_c_double * nu))
      constants = [lambda, shear_modulus, yield_stress]
    end associate
    if (.not. is_finite([lambda, shear_modulus])) message = 'youngs_modulus gives moduli that are not finite'
  end subroutine make_constants

  ! CHANGE the law: one step of one point. The engine has turned the start stress with the material. `after` holds the start.
  subroutine update_point(constants, before, after)
    real(c_double), intent(in) :: constants(:)
    type(lahar_point), intent(in) :: before
    type(lahar_point_end), intent(inout) :: after
    real(c_double) :: volumetric, two_g, s(6), mises, share
    associate (lambda => constants(1), shear_modulus => constants(2), yield_stress => constants(3), &
        strain => before%strain_increment, density => before%inputs(1))
      ! the elastic trial
      volumetric = lambda * (strain(1) + strain(2) + strain(3))
      two_g = 2.0_c_double * shear_modulus
      after%stress(1:3) = before%stress(1:3) + volumetric + two_g * strain(1:3)
      after%stress(4:6) = before%stress(4:6) + two_g * strain(4:6)
      ! its deviator and von Mises stress
      s = after%stress
      s(1:3) = s(1:3) - (s(1) + s(2) + s(3)) / 3.0_c_double
      mises = sqrt(1.5_c_double * (s(1)**2 + s(2)**2 + s(3)**2 + 2.0_c_double * (s(4)**2 + s(5)**2 + s(6)**2)))
      ! what is beyond the cap goes back along the deviator
      share = 0.0_c_double
      if (mises > yield_stress) share = (mises - yield_stress) / mises
      after%stress = after%stress - share * s
      after%state(1) = before%state(1) + share * mises / (3.0_c_double * shear_modulus)
      ! speed of the fastest wave [m/s]: the time step follows from it, too low a speed makes the run unstable
      after%wave_speed = sqrt((lambda + two_g) / density)
    end associate
    if (.not. (is_finite(after%stress) .and. is_finite(after%state) .and. is_finite([after%wave_speed]))) &
      after%status = LAHAR_POINT_FAILED
  end subroutine update_point

  ! CHANGE names, tables, inputs and outputs. A typical value of a required parameter is one with which tools try the model. Values
  ! outside the hard bounds are refused, those outside the advised ones are warned of. The capabilities say that the routines keep
  ! nothing between calls: true as long as they write no variables of the module and no `save` variables.
  function lahar_plugin_entry_v1(host) bind(c) result(plugin)
    type(c_ptr), value :: host
    type(c_ptr) :: plugin
    type(lahar_library), pointer :: library
    type(lahar_model), pointer :: model
    library => lahar_new_library(host, id='org.example.own_material', version='1.0', author='You', licence='MIT OR Apache-2.0')
    model => library%add_model('own_material', summary='Linear elasticity with a von Mises cap', &
        reference='Simo, Hughes: Computational Inelasticity (1998), section 3.3, doi:10.1007/b98904', &
        kinematics=LAHAR_KINEMATICS_STRAIN_INCREMENT, inputs=[LAHAR_INPUT_DENSITY], &
        outputs=LAHAR_OUTPUT_WAVE_SPEED + LAHAR_OUTPUT_STATUS, &
        capabilities=LAHAR_CAPABILITY_THREAD_SAFE + LAHAR_CAPABILITY_POINTWISE + LAHAR_CAPABILITY_DETERMINISTIC, &
        constants=make_constants, point=update_point)
    call model%add_parameter('youngs_modulus', 'E', 'Pa', "Young's modulus", typical=1e7_c_double, &
        hard_min=tiny(1.0_c_double))
    call model%add_parameter('poissons_ratio', 'nu', '-', "Poisson's ratio", typical=0.3_c_double, &
        hard_min=-0.999_c_double, hard_max=0.4999_c_double, advised_min=0.0_c_double, advised_max=0.495_c_double)
    call model%add_parameter('yield_stress', 'Y', 'Pa', 'Largest von Mises stress', typical=1e4_c_double, &
        hard_min=tiny(1.0_c_double))
    call model%add_state('equivalent_plastic_strain', '-', 'Integral of the rate of plastic strain')
    plugin = library%table()
  end function lahar_plugin_entry_v1

  pure logical function is_finite(x)
    real(c_double), intent(in) :: x(:)
    is_finite = all(abs(x) <= huge(x))
  end function is_finite
end module own_material
