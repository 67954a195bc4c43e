! 01_hello: a block falls, and its position is compared with g t^2 / 2. The twin of 01_hello.c: it prints the same numbers.
!
! The module `lahar` is compiled with the program. From the folder of the repository:
!
!   gfortran -std=f2018 -Wall -O2 include/lahar/lahar.f90 examples-c/01_hello.f90 \
!     -Ltarget/release -llahar -Wl,-rpath,$PWD/target/release -o 01_hello_f90
!   LAHAR_PLUGIN_PATH=$PWD/target/release ./01_hello_f90 [number of steps, 1000 if not given]

program hello
  use, intrinsic :: iso_c_binding, only: c_int32_t
  use lahar
  implicit none
  real(lahar_real), parameter :: gravity = 9.81_lahar_real, dt = 5e-4_lahar_real ! [m/s^2], [s]
  type(lahar_context) :: context
  type(lahar_material) :: rubber
  type(lahar_world) :: world
  type(lahar_world_options) :: options
  type(lahar_fill) :: fill
  type(lahar_totals) :: at_start, at_end
  real(lahar_real) :: low(3), high(3), time, fall
  integer(lahar_index) :: body
  integer(c_int32_t) :: major(1), minor(1), patch(1)
  integer :: steps, step

  steps = argument(1, 1000)

  ! A context: threads (as LAHAR_NUM_THREADS says, else 1), log, plugins.
  call context%create()
  call context%log_to_stderr(LAHAR_LOG_WARNING)
  if (lahar_version(major, minor, patch) /= LAHAR_OK) error stop lahar_message()
  call print('version_major', real(major(1), lahar_real))
  call print('version_minor', real(minor(1), lahar_real))
  call print('version_patch', real(patch(1), lahar_real))
  call print('abi_version', real(lahar_abi_version_function(), lahar_real))
  call print('threads', real(context%thread_count(), lahar_real))

  ! A material: a model of a plugin with values of its parameters.
  call context%load_plugin('lahar_linear_elastic')
  call rubber%create(context, 'linear_elastic', [character(14) :: 'youngs_modulus', 'poissons_ratio'], &
      [1e6_lahar_real, 0.3_lahar_real])

  ! A world in plane strain with cells of 0.1 m. There is no box: the grid follows the particles.
  options = lahar_default_options()
  options%dimension = 2
  options%spacing = 0.1_lahar_real
  options%gravity(2) = -gravity
  call world%create(context, options)

  ! A body: a square of 1 m that hangs 5 m above the ground, 2 x 2 particles a cell.
  low = [0.0_lahar_real, 5.0_lahar_real, 0.0_lahar_real]
  high = [1.0_lahar_real, 6.0_lahar_real, 0.0_lahar_real]
  fill = lahar_default_fill()
  fill%density = 1000.0_lahar_real
  call world%add_box(rubber, low, high, fill, body)

  at_start = world%totals(body)
  call print('particles', real(at_start%particles, lahar_real))
  call print('mass', at_start%mass)
  call print('stable_dt', world%stable_dt())
  call print('start_x', at_start%center_of_mass(1))
  call print('start_y', at_start%center_of_mass(2))

  do step = 1, steps
    call world%step(dt)
  end do

  ! Each step moves the body with its new velocity, hence falls g t dt / 2 further than g t^2 / 2.
  at_end = world%totals(body)
  time = world%time()
  fall = at_start%center_of_mass(2) - at_end%center_of_mass(2)
  call print('time', time)
  call print('end_x', at_end%center_of_mass(1))
  call print('end_y', at_end%center_of_mass(2))
  call print('velocity_y', at_end%momentum(2) / at_end%mass)
  call print('fall', fall)
  call print('fall_exact', 0.5_lahar_real * gravity * time * time)
  call print('fall_of_the_scheme', 0.5_lahar_real * gravity * time * (time + dt))

  call world%free()
  call rubber%free()
  call context%free()

contains

  !> A whole number from the command line.
  integer function argument(position, otherwise)
    integer, intent(in) :: position, otherwise
    character(32) :: text
    argument = otherwise
    if (command_argument_count() < position) return
    call get_command_argument(position, text)
    read (text, *) argument
  end function argument

  !> One line `name = value` that reads back to the same number.
  subroutine print(name, value)
    character(*), intent(in) :: name
    real(lahar_real), intent(in) :: value
    write (*, '(a, " = ", es25.17e3)') name, value
  end subroutine print
end program hello
