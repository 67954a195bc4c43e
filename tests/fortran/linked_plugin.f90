!> The twin of tests/c/linked_plugin.c: the template's model, compiled into the program and registered by its entry.
program linked_plugin
  use, intrinsic :: iso_c_binding, only: c_double, c_int64_t
  use lahar
  use own_material, only: lahar_plugin_entry_v1
  implicit none
  type(lahar_context) :: context
  type(lahar_material) :: material
  type(lahar_world) :: world
  type(lahar_world_options) :: options
  type(lahar_wall) :: wall
  type(lahar_fill) :: fill
  integer(c_int64_t) :: index, again, body, k
  real(c_double), allocatable :: strain(:)
  real(c_double) :: total
  call context%create(1)
  call context%register_plugin(lahar_plugin_entry_v1, index)
  call context%register_plugin(lahar_plugin_entry_v1, again)
  call material%create(context, 'own_material', [character(14) :: 'youngs_modulus', 'poissons_ratio', 'yield_stress'], &
      [1e6_c_double, 0.3_c_double, 1e3_c_double])
  options = lahar_default_options()
  options%dimension = 2
  options%spacing = 0.1_c_double
  options%gravity(2) = -9.81_c_double
  call world%create(context, options)
  wall = lahar_default_wall()
  wall%axis = 1
  call world%add_wall(wall)
  fill = lahar_default_fill()
  fill%density = 1600
  call world%add_box(material, [0.0_c_double, 0.0_c_double, 0.0_c_double], [1.0_c_double, 1.0_c_double, 0.0_c_double], fill, &
      body)
  call world%advance(0.2_c_double, 10000_c_int64_t)
  allocate (strain(world%particle_count(body)))
  call world%read(body, 'equivalent_plastic_strain', strain)
  total = 0
  do k = 1, size(strain, kind=c_int64_t)
    total = total + strain(k)
  end do
  print '(i0)', index, again
  print '(es25.17e3)', total
  call world%free()
  call material%free()
  call context%free()
end program linked_plugin
