! 20_own_material: a column of clay collapses; its material is a model of your own, loaded from the library that is named first. The twin
! of 20_own_material.c, where the physics stand: it takes the same arguments and prints the same numbers.
! docs/book/write_a_material.md tells how to make your own. From the folder of the repository:
!
!   gfortran -std=f2018 -O2 include/lahar/lahar.f90 examples-c/20_own_material.f90 -Ltarget/release -llahar \
!     -Wl,-rpath,$PWD/target/release -o own_column
!   ./own_column ./libown_material.so

module own_column
  use lahar
  implicit none
  private
  public :: settings, read_arguments, collapse

  integer, parameter :: outputs = 5
  real(lahar_real), parameter :: width = 1.0_lahar_real, height = 1.0_lahar_real ! SI units
  real(lahar_real), parameter :: density = 1800.0_lahar_real, gravity = 9.81_lahar_real

  type :: settings
    character(:), allocatable :: library
    real(lahar_real) :: yield_stress = sqrt(3.0_lahar_real) * (density * gravity) * height / 16.0_lahar_real
    integer(lahar_index) :: cells = 24, steps_left = huge(0_lahar_index)
  end type settings

contains

  subroutine read_arguments(s)
    type(settings), intent(out) :: s
    character(1024) :: text
    integer :: i, equals
    if (command_argument_count() < 1) error stop 'usage: own_column libown_material.so [yield_stress=...] [cells=...] [steps=...]'
    call get_command_argument(1, text)
    s%library = trim(text)
    do i = 2, command_argument_count()
      call get_command_argument(i, text)
      equals = index(text, '=')
      select case (text(:equals))
      case ('yield_stress=')
        read (text(equals + 1:), *) s%yield_stress
      case ('cells=')
        read (text(equals + 1:), *) s%cells
      case ('steps=')
        read (text(equals + 1:), *) s%steps_left
      case default
        error stop 'usage: own_column libown_material.so [yield_stress=...] [cells=...] [steps=...]'
      end select
    end do
  end subroutine read_arguments

  !> Clay whose elastic waves are fifteen times as fast as a fall from half the height.
  subroutine make_clay(context, yield_stress, clay)
    type(lahar_context), intent(in) :: context
    real(lahar_real), intent(in) :: yield_stress
    type(lahar_material), intent(out) :: clay
    real(lahar_real), parameter :: nu = 0.3_lahar_real
    real(lahar_real) :: wave_speed, modulus
    wave_speed = 15.0_lahar_real * sqrt(gravity * height)
    modulus = density * wave_speed * wave_speed
    call clay%create(context, 'own_material', [character(14) :: 'youngs_modulus', 'poissons_ratio', 'yield_stress'], &
        [modulus * (1.0_lahar_real + nu) * (1.0_lahar_real - 2.0_lahar_real * nu) / (1.0_lahar_real - nu), nu, yield_stress])
  end subroutine make_clay

  !> A smooth wall at x = 0, the plane of symmetry, and a rough floor at y = 0.
  subroutine make_world(context, h, world)
    type(lahar_context), intent(in) :: context
    real(lahar_real), intent(in) :: h
    type(lahar_world), intent(out) :: world
    type(lahar_world_options) :: options
    type(lahar_wall) :: wall
    options = lahar_default_options()
    options%dimension = 2
    options%spacing = h
    options%gravity(2) = -gravity
    call world%create(context, options)
    wall = lahar_default_wall()
    wall%axis = 0
    wall%kind = LAHAR_WALL_SLIP
    call world%add_wall(wall)
    wall%axis = 1
    wall%kind = LAHAR_WALL_STICKY
    call world%add_wall(wall)
  end subroutine make_world

  !> Where the column ends, how high it stands at the wall, and how far it has been sheared.
  subroutine print_output(world, body, h, number)
    type(lahar_world), intent(in) :: world
    integer(lahar_index), intent(in) :: body
    real(lahar_real), intent(in) :: h
    integer, intent(in) :: number
    real(lahar_real), allocatable :: position(:, :), strain(:)
    real(lahar_real) :: front, top
    integer(lahar_index) :: i, count
    character(16) :: head
    count = world%particle_count(body)
    allocate (position(2, count), strain(count))
    call world%read(body, 'position', position)
    call world%read(body, 'equivalent_plastic_strain', strain)
    front = 0.0_lahar_real
    top = 0.0_lahar_real
    do i = 1, count
      front = max(front, position(1, i) + 0.25_lahar_real * h)
      if (position(1, i) < 2.0_lahar_real * h) top = max(top, position(2, i) + 0.25_lahar_real * h)
    end do
    write (head, '(a, i0, a)') 'output', number, '_'
    call print(trim(head)//'time', world%time())
    call print(trim(head)//'run_out', (front - width) / width)
    call print(trim(head)//'height', top / height)
    call print(trim(head)//'plastic_strain', max(0.0_lahar_real, maxval(strain)))
  end subroutine print_output

  subroutine collapse(s)
    type(settings), intent(inout) :: s
    type(lahar_context) :: context
    type(lahar_material) :: clay
    type(lahar_world) :: world
    type(lahar_fill) :: fill
    type(lahar_totals) :: at_start, at_end
    real(lahar_real) :: h, weight, strength, end_time, length
    integer(lahar_index) :: body, steps
    integer :: number
    call context%create()
    call context%log_to_stderr(LAHAR_LOG_WARNING)
    call context%load_plugin(s%library) ! a path: it has a slash
    h = width / real(s%cells, lahar_real)
    weight = density * gravity
    strength = s%yield_stress / sqrt(3.0_lahar_real)
    end_time = 6.0_lahar_real * sqrt(height / gravity)
    call make_clay(context, s%yield_stress, clay)
    call make_world(context, h, world)
    fill = lahar_default_fill()
    fill%density = density
    call world%add_box(clay, [0.0_lahar_real, 0.0_lahar_real, 0.0_lahar_real], [width, height, 0.0_lahar_real], fill, body)
    call world%set_f_bar(body, .true.) ! plastic flow keeps the volume: without F-bar it locks
    at_start = world%totals(body)
    call print('particles', real(world%particle_count(body), lahar_real))
    call print('weight_over_strength', weight * height / strength)

    do number = 1, outputs
      call world%advance(end_time * number / outputs, s%steps_left, steps)
      if (s%steps_left < huge(s%steps_left)) s%steps_left = s%steps_left - steps
      call print_output(world, body, h, number)
    end do
    at_end = world%totals(body)
    length = (1.5_lahar_real * width * height / sqrt(2.0_lahar_real * strength / weight))**(2.0_lahar_real / 3.0_lahar_real)
    call print('steps', real(world%step_count(), lahar_real))
    call print('kinetic_over_start_potential', at_end%kinetic_energy / at_start%potential_energy)
    call print('run_out_of_a_shallow_layer', length / width - 1.0_lahar_real)
    call world%free()
    call clay%free()
    call context%free()
  end subroutine collapse

  !> One line `name = value` that reads back to the same number.
  subroutine print(name, value)
    character(*), intent(in) :: name
    real(lahar_real), intent(in) :: value
    write (*, '(a, " = ", es25.17e3)') name, value
  end subroutine print
end module own_column

program main
  use own_column
  implicit none
  type(settings) :: s
  call read_arguments(s)
  call collapse(s)
end program main
