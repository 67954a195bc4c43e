C     A guest without manners, elastic by PROPS(1) = lambda + 2 mu and PROPS(2) = mu: it writes into everything that it is given,
C     remembers calls, prints, wants half the step, counts its calls into STATEV(1), and calls XIT if PROPS(3) is 1.
      SUBROUTINE UMAT(STRESS,STATEV,DDSDDE,SSE,SPD,SCD,
     1 RPL,DDSDDT,DRPLDE,DRPLDT,STRAN,DSTRAN,TIME,DTIME,TEMP,DTEMP,
     2 PREDEF,DPRED,CMNAME,NDI,NSHR,NTENS,NSTATV,PROPS,NPROPS,COORDS,
     3 DROT,PNEWDT,CELENT,DFGRD0,DFGRD1,NOEL,NPT,LAYER,KSPT,KSTEP,KINC)
      INCLUDE 'aba_param.inc'
      CHARACTER*80 CMNAME
      DIMENSION STRESS(NTENS),STATEV(NSTATV),DDSDDE(NTENS,NTENS),
     1 DDSDDT(NTENS),DRPLDE(NTENS),STRAN(NTENS),DSTRAN(NTENS),TIME(2),
     2 PREDEF(1),DPRED(1),PROPS(NPROPS),COORDS(3),DROT(3,3),
     3 DFGRD0(3,3),DFGRD1(3,3),KSTEP(4)
      DIMENSION INTV(1),REALV(1)
      CHARACTER*8 CHARV(1)
      SAVE NCALLS
      DATA NCALLS /0/
      NCALLS = NCALLS+1
      IF (NPROPS.GT.2) THEN
        IF (PROPS(3).EQ.1.D0) THEN
          INTV(1) = NOEL
          REALV(1) = 2.5D0
          CHARV(1) = CMNAME(1:8)
          CALL STDB_ABQERR(-1,'element %I of %S: %R',INTV,REALV,CHARV)
          CALL XIT
          STRESS(1) = -1.D30
        END IF
        IF (PROPS(3).EQ.2.D0) STATEV(NSTATV+1) = 1.D0
        IF (PROPS(3).EQ.4.D0) STATEV(NSTATV+100) = 1.D0
        IF (PROPS(3).EQ.3.D0) STRESS(1) = STRESS(1)/0.D0*0.D0
      END IF
      A = PROPS(1)
      G = PROPS(2)
      DO I = 1,NTENS
        D = 2.D0*G
        IF (I.GT.NDI) D = G
        STRESS(I) = STRESS(I)+D*DSTRAN(I)
        DDSDDE(I,I) = D
      END DO
      DO I = 1,NDI
        DO J = 1,NDI
          DDSDDE(I,J) = DDSDDE(I,J)+A-2.D0*G
          STRESS(I) = STRESS(I)+(A-2.D0*G)*DSTRAN(J)
        END DO
      END DO
      IF (NCALLS.EQ.1) WRITE(*,*) 'a rude UMAT says hello'
      PNEWDT = 0.5D0
      STATEV(1) = NCALLS
C     From here on it spoils what it does not own.
      CALL SPOIL(STRAN,DSTRAN,NTENS)
      TIME(1) = -1.D0
      TIME(2) = -1.D0
      DTIME = 0.D0
      TEMP = -1.D0
      PREDEF(1) = -1.D0
      CMNAME = 'spoilt'
      NDI = 0
      NSHR = 0
      DO I = 1,NPROPS
        PROPS(I) = 0.D0
      END DO
      NPROPS = 0
      COORDS(1) = 1.D99
      DROT(1,2) = 7.D0
      CELENT = 0.D0
      DFGRD0(1,1) = 0.D0
      DFGRD1(1,1) = 0.D0
      NOEL = 0
      NPT = 0
      LAYER = 0
      KSPT = 0
      KSTEP(1) = 0
      KINC = 0
      NTENS = 0
      NSTATV = 0
      END

      SUBROUTINE SPOIL(A,B,N)
      INCLUDE 'ABA_PARAM.INC'
      DIMENSION A(N),B(N)
      DO I = 1,N
        A(I) = 1.D99
        B(I) = 1.D99
      END DO
      END
