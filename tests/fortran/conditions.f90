!> The twin of tests/c/conditions.c in the readable layer: a block of elastic ground with every condition.
program conditions
  use, intrinsic :: iso_c_binding, only: c_double, c_int64_t
  use lahar
  implicit none
  real(c_double), parameter :: times(2) = [0.0_c_double, 0.05_c_double]
  real(c_double), parameter :: gravity(3, 2) = reshape([0.0_c_double, -9.81_c_double, 0.0_c_double, 1.0_c_double, &
      -12.0_c_double, 0.0_c_double], [3, 2])
  real(c_double), parameter :: velocities(3, 2) = reshape([0.0_c_double, 0.0_c_double, 0.0_c_double, 0.01_c_double, &
      0.0_c_double, 0.0_c_double], [3, 2])
  type(lahar_context) :: context
  type(lahar_material) :: material
  type(lahar_world) :: world
  type(lahar_world_options) :: options
  type(lahar_wall) :: wall
  type(lahar_fill) :: fill
  type(lahar_traction) :: traction
  type(lahar_prescribed_velocity) :: pull
  type(lahar_settle_criteria) :: criteria
  type(lahar_settle_result) :: settled
  type(lahar_equilibrium) :: before, after
  integer(c_int64_t) :: body, load, pulled, carriers
  integer :: stat
  logical :: converged
  real(c_double) :: force(3), reaction(3), area
  character(400) :: message
  call context%create(1)
  call context%load_plugin('lahar_linear_elastic')
  call material%create(context, 'linear_elastic', [character(14) :: 'youngs_modulus', 'poissons_ratio'], &
      [1e6_c_double, 0.3_c_double])
  options = lahar_default_options()
  options%dimension = 2
  options%spacing = 0.1_c_double
  options%gravity(2) = -9.81_c_double
  call world%create(context, options)
  wall = lahar_default_wall()
  wall%axis = 1
  call world%add_wall(wall)
  fill = lahar_default_fill()
  fill%density = 2000
  call world%add_box(material, [0.0_c_double, 0.0_c_double, 0.0_c_double], &
      [1.0_c_double, 1.0_c_double, 0.0_c_double], fill, body)
  call world%set_damping(0.5_c_double)
  call world%set_gravity([0.0_c_double, -9.81_c_double, 0.0_c_double])
  call world%set_k0_stress(body, 1.0_c_double, 0.4_c_double)
  call world%init_state(body)
  before = world%equilibrium()
  ! mistakes are told
  call world%set_gravity_table(times(2:1:-1), gravity, stat, message)
  if (stat /= LAHAR_ERROR_INVALID_ARGUMENT .or. index(message, 'end before it begins') == 0) error stop 'backwards'
  call world%set_gravity_table(times, gravity(:, 1:1), stat, message)
  if (stat == LAHAR_OK .or. index(message, 'shape') == 0) error stop 'shape'
  call world%set_gravity_table(times, gravity)
  traction = lahar_default_traction()
  call world%add_traction(traction, stat=stat, errmsg=message)
  if (stat /= LAHAR_ERROR_INVALID_ARGUMENT) error stop 'a traction without a box'
  traction%body = body
  traction%axis = 1
  traction%box_min = [0.0_c_double, 0.95_c_double, 0.0_c_double]
  traction%box_max = 1
  traction%traction = [0.0_c_double, -500.0_c_double, 0.0_c_double]
  call world%add_traction(traction, times, [0.0_c_double], stat=stat, errmsg=message)
  if (stat == LAHAR_OK .or. index(message, 'length') == 0) error stop 'lengths'
  call world%add_traction(traction, times, [0.0_c_double, 2.0_c_double], load)
  pull = lahar_default_prescribed_velocity()
  pull%components = LAHAR_COMPONENT_X
  pull%box_min = -1
  pull%box_max = [0.05_c_double, 2.0_c_double, 2.0_c_double]
  call world%add_prescribed_velocity(pull, times, stat=stat, errmsg=message)
  if (stat == LAHAR_OK .or. index(message, 'together') == 0) error stop 'times without velocities'
  call world%add_prescribed_velocity(pull, times, velocities, pulled)
  criteria = lahar_default_settle_criteria()
  criteria%max_steps = 120
  call world%settle(criteria, converged, settled)
  after = world%equilibrium()
  force = world%traction_force(load, carriers, area)
  reaction = world%prescribed_velocity_reaction(pulled)
  call print_real('start_unbalanced', before%unbalanced_force)
  call print_real('start_external', before%external_force)
  print '(a, i0)', 'converged = ', merge(1, 0, converged)
  print '(a, i0)', 'steps = ', settled%steps
  call print_real('time', settled%time)
  call print_real('kinetic_ratio', after%kinetic_ratio)
  call print_real('unbalanced_ratio', after%unbalanced_ratio)
  print '(a, i0)', 'carriers = ', carriers
  call print_real('area', area)
  call print_real('force', force(2))
  call print_real('reaction', reaction(1))
  call world%remove_traction(load)
  call world%remove_prescribed_velocity(pulled)
  call world%free()
  call material%free()
  call context%free()

contains

  subroutine print_real(name, value)
    character(*), intent(in) :: name
    real(c_double), intent(in) :: value
    print '(2a, es25.17)', name, ' = ', value
  end subroutine print_real

end program conditions
