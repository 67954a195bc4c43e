C     Von Mises plasticity with linear isotropic hardening as a VUMAT; props as those of von_mises.f90.
      subroutine vumat(
     1  nblock, ndir, nshr, nstatev, nfieldv, nprops, lanneal,
     2  stepTime, totalTime, dt, cmname, coordMp, charLength,
     3  props, density, strainInc, relSpinInc,
     4  tempOld, stretchOld, defgradOld, fieldOld,
     5  stressOld, stateOld, enerInternOld, enerInelasOld,
     6  tempNew, stretchNew, defgradNew, fieldNew,
     7  stressNew, stateNew, enerInternNew, enerInelasNew )
      include 'vaba_param.inc'
      dimension props(nprops), density(nblock), coordMp(nblock,*),
     1  charLength(nblock), strainInc(nblock,ndir+nshr),
     2  relSpinInc(nblock,nshr), tempOld(nblock),
     3  stretchOld(nblock,ndir+nshr), defgradOld(nblock,ndir+2*nshr),
     4  fieldOld(nblock,nfieldv), stressOld(nblock,ndir+nshr),
     5  stateOld(nblock,nstatev), enerInternOld(nblock),
     6  enerInelasOld(nblock), tempNew(nblock),
     7  stretchNew(nblock,ndir+nshr), defgradNew(nblock,ndir+2*nshr),
     8  fieldNew(nblock,nfieldv), stressNew(nblock,ndir+nshr),
     9  stateNew(nblock,nstatev), enerInternNew(nblock),
     1  enerInelasNew(nblock)
      character*80 cmname
      dimension s(6)
      g = props(1)/(2.d0*(1.d0+props(2)))
      alambda = 2.d0*g*props(2)/(1.d0-2.d0*props(2))
      ntens = ndir+nshr
      do k = 1,nblock
        trace = strainInc(k,1)+strainInc(k,2)+strainInc(k,3)
        do i = 1,ntens
          s(i) = stressOld(k,i)+2.d0*g*strainInc(k,i)
          if (i.le.ndir) s(i) = s(i)+alambda*trace
        end do
        amean = (s(1)+s(2)+s(3))/3.d0
        q = 0.d0
        do i = 1,ntens
          if (i.le.ndir) then
            q = q+(s(i)-amean)**2
          else
            q = q+2.d0*s(i)**2
          end if
        end do
        q = sqrt(1.5d0*q)
        yield = props(3)+props(4)*stateOld(k,1)
        gamma = max(q-yield,0.d0)/(3.d0*g+props(4))
        if (stepTime.eq.0.d0 .and. totalTime.eq.0.d0) gamma = 0.d0
        stateNew(k,1) = stateOld(k,1)+gamma
        factor = 1.d0
        if (gamma.gt.0.d0) factor = 1.d0-3.d0*g*gamma/q
        work = 0.d0
        do i = 1,ntens
          if (i.le.ndir) then
            stressNew(k,i) = amean+factor*(s(i)-amean)
            work = work+stressNew(k,i)*strainInc(k,i)
          else
            stressNew(k,i) = factor*s(i)
            work = work+2.d0*stressNew(k,i)*strainInc(k,i)
          end if
        end do
        enerInternNew(k) = enerInternOld(k)+work/density(k)
        enerInelasNew(k) = enerInelasOld(k)
     1    +gamma*(yield+props(4)*gamma)/density(k)
      end do
      end
