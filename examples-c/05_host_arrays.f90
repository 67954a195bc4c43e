! 05_host_arrays: a bank of soil that lives in the arrays of the host. The twin of 05_host_arrays.c, which tells the story: it
! takes the same arguments and prints the same numbers.
!
! The module takes the arrays that Fortran hosts have: position(2, n), stress(6, n), volume(n), contiguous and in the order
! of the ids. Columns such as velocity(n, 2) are transposed on the way.

module bank
  use lahar
  implicit none
  private
  public :: density, gravity, height, youngs_modulus, poissons_ratio, host, geostatic, make_world, add_bank, steps_of, &
      rest, look, stop_bank, forget, argument, print

  real(lahar_real), parameter :: height = 1.0_lahar_real, width = 1.0_lahar_real, gravity = 9.81_lahar_real
  real(lahar_real), parameter :: density = 2000.0_lahar_real, youngs_modulus = 1e7_lahar_real ! SI units
  real(lahar_real), parameter :: poissons_ratio = 0.35_lahar_real ! with 0.3 this soil would yield already at rest

  !> What the host knows.
  type :: host
    integer :: count = 0
    real(lahar_real), allocatable :: x(:, :), velocity(:, :), volume(:), stress(:, :) ! (2, n), (n, 2), (n), (6, n)
  end type host

contains

  subroutine geostatic(cells, h)
    integer, intent(in) :: cells
    type(host), intent(out) :: h
    real(lahar_real) :: pitch, k0, vertical
    integer :: columns, k
    columns = 2 * cells ! 2 x 2 particles a cell
    pitch = 0.5_lahar_real * height / cells
    k0 = poissons_ratio / (1.0_lahar_real - poissons_ratio)
    h%count = columns * columns
    allocate (h%x(2, h%count), h%velocity(h%count, 2), h%volume(h%count), h%stress(6, h%count))
    h%velocity = 0.0_lahar_real
    h%volume = pitch * pitch
    do k = 1, h%count
      h%x(1, k) = (mod(k - 1, columns) + 0.5_lahar_real) * pitch
      h%x(2, k) = ((k - 1) / columns + 0.5_lahar_real) * pitch
      vertical = -density * gravity * (height - h%x(2, k))
      h%stress(:, k) = [k0 * vertical, vertical, k0 * vertical, 0.0_lahar_real, 0.0_lahar_real, 0.0_lahar_real]
    end do
  end subroutine geostatic

  !> Slip walls left, right and below.
  subroutine make_world(context, cells, world, right)
    type(lahar_context), intent(in) :: context
    integer, intent(in) :: cells
    type(lahar_world), intent(inout) :: world
    integer(lahar_index), intent(out) :: right
    type(lahar_world_options) :: options
    type(lahar_wall) :: wall
    options = lahar_default_options()
    options%dimension = 2
    options%spacing = height / cells
    options%gravity(2) = -gravity
    call world%create(context, options)
    wall = lahar_default_wall()
    wall%kind = LAHAR_WALL_SLIP
    wall%axis = 0
    call world%add_wall(wall)
    wall%axis = 1
    call world%add_wall(wall)
    wall%axis = 0
    wall%side = -1
    wall%position = width
    call world%add_wall(wall, right)
  end subroutine make_world

  subroutine add_bank(world, soil, h, body)
    type(lahar_world), intent(inout) :: world
    type(lahar_material), intent(in) :: soil
    type(host), intent(in) :: h
    integer(lahar_index), intent(out) :: body
    call world%add_particles(soil, h%x, h%volume, density=density, velocity=transpose(h%velocity), stress=h%stress, &
        body=body)
  end subroutine add_bank

  subroutine steps_of(world, steps)
    type(lahar_world), intent(inout) :: world
    integer, intent(in) :: steps
    integer :: step
    do step = 1, steps
      call world%step()
    end do
  end subroutine steps_of

  !> Compares the stresses with those of the start.
  subroutine rest(world, body, h)
    type(lahar_world), intent(in) :: world
    integer(lahar_index), intent(in) :: body
    type(host), intent(in) :: h
    real(lahar_real), allocatable :: stress(:, :)
    allocate (stress(6, h%count))
    call world%read(body, 'stress', stress)
    call print('rest_stress_yy_of_particle_0', stress(2, 1))
    call print('rest_stress_change_over_base_stress', maxval(abs(stress - h%stress)) / (density * gravity * height))
  end subroutine rest

  !> The memory itself, without a copy. Its order is that of storage; the ids tell whose value is whose.
  subroutine look(world, body, h)
    type(lahar_world), intent(inout) :: world
    integer(lahar_index), intent(in) :: body
    type(host), intent(in) :: h
    type(lahar_view) :: view
    real(lahar_real), pointer :: values(:, :)
    real(lahar_real), allocatable :: by_id(:)
    integer(lahar_index), allocatable :: ids(:)
    integer :: wrong
    allocate (by_id(h%count), ids(h%count))
    call world%ids(body, ids)
    call world%read(body, 'equivalent_plastic_strain', by_id)
    call world%view(body, 'equivalent_plastic_strain', LAHAR_ACCESS_READ, view)
    call view%data(values)
    wrong = count(values(:, 1) < by_id(ids + 1) .or. values(:, 1) > by_id(ids + 1))
    call print('slide_largest_plastic_strain', maxval(values(:, 1)))
    call print('view_differs_from_copy', real(wrong, lahar_real))
    call view%free()

    call world%view(body, 'position', LAHAR_ACCESS_READ, view)
    call view%data(values)
    call print('slide_toe_x', maxval(values(:, 1)))
    call print('slide_top_y', maxval(values(:, 2)))
    call view%free()
  end subroutine look

  !> Stops the bank through a view that writes; while it is open the world does not step.
  subroutine stop_bank(world, body)
    type(lahar_world), intent(inout) :: world
    integer(lahar_index), intent(in) :: body
    type(lahar_view) :: view
    real(lahar_real), pointer :: velocity(:, :)
    integer :: status
    call world%view(body, 'velocity', LAHAR_ACCESS_WRITE, view)
    call view%data(velocity)
    velocity = 0.0_lahar_real
    call world%step(stat=status)
    call print('step_with_open_view_is_refused', merge(1.0_lahar_real, 0.0_lahar_real, status == LAHAR_ERROR_VIEW_OPEN))
    call view%free()
  end subroutine stop_bank

  !> Writes a state variable of the model by its name, in the order of the ids.
  subroutine forget(world, body, count)
    type(lahar_world), intent(inout) :: world
    integer(lahar_index), intent(in) :: body
    integer, intent(in) :: count
    real(lahar_real) :: strain(count)
    strain = 0.0_lahar_real
    call world%write(body, 'equivalent_plastic_strain', strain)
    call world%read(body, 'equivalent_plastic_strain', strain)
    call print('forgotten_largest_plastic_strain', maxval(strain))
  end subroutine forget

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
end module bank

program host_arrays
  use lahar
  use bank
  implicit none
  type(lahar_context) :: context
  type(lahar_material) :: soil
  type(lahar_world) :: world
  type(lahar_totals) :: totals
  type(host) :: h
  integer(lahar_index) :: body, right
  integer :: cells, steps
  real(lahar_real) :: force(3)

  cells = argument(1, 10)
  steps = argument(2, 300)
  call context%create()
  call context%log_to_stderr(LAHAR_LOG_WARNING)
  call context%load_plugin('lahar_drucker_prager')
  call soil%create(context, 'drucker_prager', &
      [character(14) :: 'youngs_modulus', 'poissons_ratio', 'friction_angle', 'cohesion', 'cone'], &
      [youngs_modulus, poissons_ratio, 30.0_lahar_real, 0.0_lahar_real, 2.0_lahar_real]) ! cone 2: plane strain
  call geostatic(cells, h)
  call make_world(context, cells, world, right)
  call add_bank(world, soil, h, body)
  totals = world%totals(body)
  call print('particles', real(totals%particles, lahar_real))
  call print('mass', totals%mass)
  call print('start_center_y', totals%center_of_mass(2))

  call steps_of(world, steps)
  call rest(world, body, h)
  force = world%wall_reaction(right)
  totals = world%totals(body)
  call print('rest_kinetic_over_potential', totals%kinetic_energy / totals%potential_energy)
  call print('rest_force_of_right_wall', force(1))
  call print('earth_pressure_at_rest', -0.5_lahar_real * poissons_ratio / (1.0_lahar_real - poissons_ratio) * density * &
      gravity * height * height)

  call world%remove_wall(right)
  call steps_of(world, steps)
  call look(world, body, h)
  totals = world%totals(body)
  call print('slide_momentum_x', totals%momentum(1))
  call print('slide_center_y', totals%center_of_mass(2))
  call stop_bank(world, body)
  call forget(world, body, h%count)
  totals = world%totals(body)
  call print('stopped_kinetic_energy', totals%kinetic_energy)
  call steps_of(world, 1)
  totals = world%totals(body)
  call print('slides_again', merge(1.0_lahar_real, 0.0_lahar_real, totals%momentum(1) > 0.0_lahar_real))

  call world%free()
  call soil%free()
  call context%free()
end program host_arrays
