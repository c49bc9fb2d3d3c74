//! Tests of the driver beyond the vectors, in virtual time.

use super::*;
use crate::Fault;
use crate::tests::common::fault_of;
use crate::{
    Assumptions, ByteOrder,
    protocol::bits::{card, message, uc},
};
use twin_drives::{Axes, DriveError};

#[tokio::test(start_paused = true)]
async fn it_tells_who_is_there() {
    let module = ModuleOptions { version: 17, rating_ma: 5000, ..ModuleOptions::default() };
    let options = Bim2AxOptions::default();
    let mut rig = Rig::new(&module, &options, &Eeprom::new(5000), &surroundings()).await;
    let identity = rig.driver.identify(&clock()).await.unwrap();
    assert_eq!((identity.version, identity.rating_ma), (17, 5000));
    assert_eq!(identity.card_messages, card::AXIS_1 | card::AXIS_2);
}

#[tokio::test(start_paused = true)]
async fn the_other_byte_order_is_found_without_changing_anything() {
    for (module_order, driver_order) in
        [(ByteOrder::Big, ByteOrder::Little), (ByteOrder::Little, ByteOrder::Big)]
    {
        let options = ModuleOptions { byte_order: module_order, ..ModuleOptions::default() };
        let module = Module::new(&options, &eeprom(), &surroundings());
        let module = SharedModule::new(module, clock());
        let mut options = Bim2AxOptions { byte_order: driver_order, ..Bim2AxOptions::default() };
        let mut driver = Bim2Ax::new("module", module.clone(), &options);
        sleep(seconds(1)).await;
        let before = module.module().stores();
        let error = driver.identify(&clock()).await.unwrap_err();
        assert!(matches!(error.fault(), Some(Fault::ByteOrder)), "{error}");
        assert_eq!(module.module().stores(), before);
        options.byte_order = module_order;
        let mut driver = Bim2Ax::new("module", module.clone(), &options);
        driver.identify(&clock()).await.unwrap();
        driver.start([Some(Start::to(-321)), None], &clock()).await.unwrap();
        let (seen, _) = driver.rested(seconds(5), &clock()).await.unwrap();
        assert_eq!(seen.positions, [-321, 0]);
    }
}

#[tokio::test(start_paused = true)]
async fn strangers_and_modules_that_do_not_run_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bus");
    std::fs::write(&path, [0xFF; 256]).unwrap();
    let memory = crate::MappedMemory::open(&path, 0).unwrap();
    let mut driver = Bim2Ax::new("bus", memory, &Bim2AxOptions::default());
    let error = driver.identify(&clock()).await.unwrap_err();
    assert!(
        matches!(error.fault(), Some(Fault::Identity { expected: 0x4E, found: 0xFF, .. })),
        "{error}"
    );

    let module = Module::new(&ModuleOptions::default(), &eeprom(), &surroundings());
    let module = SharedModule::new(module, clock());
    let mut driver = Bim2Ax::new("bus", module, &Bim2AxOptions::default());
    let error = driver.identify(&clock()).await.unwrap_err();
    assert!(matches!(error.fault(), Some(Fault::NotRunning)), "{error}");
}

#[tokio::test(start_paused = true)]
async fn modules_before_version_15_are_driven_zone_by_zone() {
    let module = ModuleOptions { version: 14, ..ModuleOptions::default() };
    let mut rig = Rig::of(&module).await;
    assert_eq!(rig.go([Some(100), Some(-200)]).await.positions, [100, -200]);
    let written = rig.log.take();
    assert!(!written.iter().any(|access| access.starts_with("70..73←7") || *access == "70←01"));
    // The zone of acknowledgements only is refreshed with an order.
    rig.driver.acknowledgements(&clock()).await.unwrap();
}

#[tokio::test(start_paused = true)]
async fn what_an_axis_does_not_do_is_told_with_its_messages() {
    let mut rig = Rig::usual().await;
    let clock = &clock();
    rig.start([Some(2000), None]).await;
    let refused = rig.driver.start([Some(Start::to(5)), None], clock).await;
    // It goes on, and that it refused is in its messages.
    assert!(
        refused.is_ok() || matches!(fault_of(&refused), Some(Fault::AxisMessages { axis: 1, .. }))
    );
    let seen = rig.rest().await;
    assert_eq!(seen.positions[0], 2000);
    assert_eq!(seen.messages[0] & message::REFUSED, message::REFUSED);

    rig.rewire(|surroundings| surroundings.benches[1].power = false);
    let error = rig.driver.start([None, Some(Start::to(5))], clock).await.unwrap_err();
    let text = error.to_string();
    assert!(text.contains("/dev/uio0: order $0002 (programmed move): axis 2:"), "{text}");
    assert!(text.contains("power absent"), "{text}");
    let error = rig.driver.home(&[ModuleAxis::Two], clock).await.unwrap_err();
    assert!(matches!(error.fault(), Some(Fault::AxisMessages { axis: 2, .. })), "{error}");

    let error = rig.driver.start([Some(Start::to(4_194_304)), None], clock).await.unwrap_err();
    assert!(matches!(error, DriveError::Range { .. }), "{error}");
    let error = rig.driver.preset(ModuleAxis::One, 0xC0DE, clock).await.unwrap_err();
    assert!(matches!(error, DriveError::Range { .. }), "{error}");
}

#[tokio::test(start_paused = true)]
async fn phases_tests_and_stops() {
    let mut rig = Rig::usual().await;
    let clock = &clock();
    rig.driver.set_phases(&BOTH, true, clock).await.unwrap();
    rig.driver.set_phases(&[ModuleAxis::Two], false, clock).await.unwrap();
    let seen = rig.seen().await;
    assert_eq!(seen.messages, [0, message::PHASES_OFF]);
    rig.driver.test_motors(&BOTH, clock).await.unwrap();
    rig.rewire(|surroundings| surroundings.benches[0].phase_short = true);
    let error = rig.driver.test_motors(&[ModuleAxis::One], clock).await.unwrap_err();
    assert!(error.to_string().contains("short circuit between phases"), "{error}");
    rig.rewire(|surroundings| surroundings.benches[0].phase_short = false);
    rig.driver.test_motors(&[ModuleAxis::One], clock).await.unwrap();

    rig.start([Some(2900), Some(-2900)]).await;
    sleep(Duration::from_millis(100)).await;
    rig.driver.abandon(clock).await.unwrap();
    assert_eq!(rig.driver.acknowledgements(clock).await.unwrap().uc, [uc::ABANDON; 2]);
    let error = rig.driver.rested(Duration::from_millis(1), clock).await.unwrap_err();
    assert!(matches!(error, DriveError::Moving { axes: Axes::Numbers(3), .. }), "{error}");
    rig.driver.rested(seconds(1), clock).await.unwrap();
    rig.start([Some(0), None]).await;
    rig.driver.stop_hard(clock).await.unwrap();
    assert_eq!(rig.driver.acknowledgements(clock).await.unwrap().uc, [uc::HARD_STOP, uc::ABANDON]);
}

#[tokio::test(start_paused = true)]
async fn samples_are_of_the_middle_of_their_exchange() {
    let mut rig = Rig::usual().await;
    let clock = &clock();
    rig.driver
        .start([Some(Start { speed: Some(1000), ..Start::to(2900) }), None], clock)
        .await
        .unwrap();
    for _ in 0..20 {
        let (seen, stamp) = rig.driver.positions(clock).await.unwrap();
        assert_eq!(stamp.answered_ns - stamp.sent_ns, 1_000_000);
        let now = rig.module.module().position(ModuleAxis::One);
        // 1000 µsteps/s: half a step in half an exchange, and the module says whole steps of 0.2 ms before.
        let then = now - 1000.0 * twin_drives::ramp::seconds(clock() - stamp.middle_ns());
        assert!((f64::from(seen.positions[0]) - then).abs() <= 0.75, "{seen:?} {then}");
    }
}

#[tokio::test(start_paused = true)]
async fn it_does_not_matter_to_the_driver_how_the_module_treats_zones() {
    for (refreshes_all, keeps_entries) in [(true, false), (false, true), (false, false)] {
        let assumptions = Assumptions { refreshes_all, keeps_entries, ..Assumptions::default() };
        let module = ModuleOptions { assumptions, ..ModuleOptions::default() };
        let mut rig = Rig::of(&module).await;
        let clock = &clock();
        rig.go([Some(300), Some(-300)]).await;
        // Had the entries been carried out again, axis 2 would go back to its old target.
        rig.manual([0, 0x10]).await;
        sleep(Duration::from_millis(100)).await;
        rig.manual([0, 0]).await;
        let (seen, _) = rig.driver.rested(seconds(1), clock).await.unwrap();
        assert_eq!(seen.positions[0], 300);
        assert!((-210..-180).contains(&seen.positions[1]), "{seen:?}");
    }
}
