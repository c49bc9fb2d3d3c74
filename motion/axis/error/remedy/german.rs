//! What to do about an error, in German.

use super::super::SmcError as E;

/// What to do about it.
#[expect(clippy::too_many_lines, reason = "a table, one line an error")]
pub(super) const fn remedy(error: E) -> &'static str {
    match error {
        E::NoError => "nichts: alles ist in Ordnung",
        E::DiGeneralCommunicationError => {
            "Leitung, ihre Enden und die Versorgung aller Antriebe daran prüfen, dann die Achsgruppe zurücksetzen"
        }
        E::DiSwlimitsExceeded => {
            "die Achse mit MC_Reset zurücksetzen und zwischen fSWLimitNegative und fSWLimitPositive zurückfahren; das Ziel berichtigen, oder die Grenzen, wenn sie falsch sind; wo Endschalter überwacht werden, meldet ein offener ebenfalls diesen Fehler"
        }
        E::RegulatorOrStartNotSet => {
            "MC_Power mit Enable, bRegulatorOn und bDriveStart TRUE aufrufen und auf Status warten, bevor die Achse bewegt wird"
        }
        E::FbWasntCalledDuringMotion => {
            "jeden Baustein, der eine Achse bewegt, in jedem Zyklus aufrufen, bis er Done zeigt, abgebrochen ist oder die Achse abgegeben hat"
        }
        E::AxisIsNoAxisRef => "dem Baustein als Axis eine Achse der Antriebskonfiguration geben",
        E::AxisRefChangedDuringOperation => {
            "dem Baustein bis zu seinem Ende dieselbe Achse geben; für jede Achse eine eigene Instanz verwenden"
        }
        E::HomingInvalidVelaccValues
        | E::MsInvalidAccdecValues
        | E::MaInvalidVelaccValues
        | E::MrInvalidVelaccValues
        | E::MadInvalidVelaccValues
        | E::MsiInvalidVelaccValues
        | E::MvInvalidAccdecValues
        | E::McrInvalidVelaccValues
        | E::McaInvalidVelaccValues => {
            "Geschwindigkeit, Beschleunigung und Verzögerung vor der steigenden Flanke von Execute größer als 0 setzen"
        }
        E::HomingModeNeedsHwlimit => {
            "bIgnoreHWLimit auf FALSE setzen, oder einen Referenziermodus ohne Endschalter wählen (0 bis 2)"
        }
        E::ScmNotSupported => {
            "eine Regelungsart verlangen, die der Antrieb hat, oder sie im Antrieb einrichten"
        }
        E::StWrongControllerMode => {
            "die Achse zuerst mit SMC_SetControllerMode auf Drehmoment schalten und auf Done warten"
        }
        E::RagErrorDuringStartup => {
            "pErrorDrive und g_strBootupError der Achsgruppe ansehen, die Ursache beseitigen und die Gruppe noch einmal zurücksetzen"
        }
        E::CgrZeroValues => {
            "dwRatioTechUnitsDenom, iRatioTechUnitsNum und bei rotatorischen Achsen die Periode auf andere Werte als 0 setzen"
        }
        E::CgrDrivePowered => {
            "die Achse mit MC_Power stromlos schalten, bevor das Verhältnis geändert wird"
        }
        E::PFtaskcycleEmpty => {
            "die Zykluszeit der Task in der Achsgruppe einstellen, damit fTaskCycle größer als 0 ist"
        }
        E::RNoErrorToReset => "nichts ist zu tun: MC_Reset nur in errorstop aufrufen",
        E::RDriveDoesntAnswer => {
            "den Fehler des Antriebs selbst nachsehen (MC_ReadAxisError), seine Ursache beseitigen und noch einmal zurücksetzen"
        }
        E::RErrorNotResettable => {
            "die Ursache im Handbuch des Antriebs suchen und beseitigen; solche Fehler verlangen oft, den Antrieb aus- und einzuschalten"
        }
        E::RDriveDoesntAnswerInTime | E::HAxisDidntAnswer | E::TpCommError => {
            "prüfen, ob der Antrieb versorgt und seine Leitung in Ordnung ist, dann noch einmal versuchen"
        }
        E::RpParamUnknown => "eine Parameternummer angeben, die die Achse oder ihr Antrieb hat",
        E::RpRequestingError | E::WpSendingError => {
            "prüfen, ob der Antrieb versorgt, seine Leitung in Ordnung und der Parameter einer ist, den er in diesem Zustand hat"
        }
        E::WpParamInvalid => {
            "eine Parameternummer angeben, die die Achse oder ihr Antrieb hat und die geschrieben werden darf"
        }
        E::HAxisWasntStandstill => "die Achse vor MC_Home anhalten und auf Stillstand warten",
        E::HAxisDidntStartHoming => {
            "prüfen, ob der Antrieb referenzieren kann, dafür eingerichtet ist und nichts ihn sperrt"
        }
        E::HErrorWhenStopping => "die Verzögerung der Achse größer als 0 setzen",
        E::MsUnknownStoppingError => {
            "den Fehler des Antriebs selbst nachsehen (MC_ReadAxisError), zurücksetzen und noch einmal anhalten"
        }
        E::MsDirectionNotApplicable | E::MvDirectionNotApplicable => {
            "als Direction positive, negative oder current angeben: ohne Ziel gibt es keinen kürzesten Weg"
        }
        E::MsAxisInErrorstop => {
            "zuerst MC_Reset aufrufen: in errorstop steht die Achse schon oder wird gerade angehalten"
        }
        E::MaInvalidDirection
        | E::MrInvalidDirection
        | E::MadInvalidDirection
        | E::MsiInvalidDirection => {
            "eine der Richtungen negative, shortest, positive, current oder fastest angeben"
        }
        E::McrInvalidDirection | E::McaInvalidDirection => {
            "als EndVelocityDirection positive, negative oder current angeben: eine Geschwindigkeit hat keinen kürzesten oder schnellsten Weg"
        }
        E::PpArraysize | E::VpArraysize | E::ApArraysize => {
            "ArraySize auf die Zahl der Punkte in der Tabelle setzen, von 1 bis 100"
        }
        E::PpStep0ms | E::VpStep0ms | E::ApStep0ms => {
            "jedem Punkt der Tabelle eine delta_time größer als 0 geben"
        }
        E::TpTriggeroccupied => {
            "den anderen MC_TouchProbe mit MC_AbortTrigger beenden, oder einen anderen Trigger nehmen"
        }
        E::TpCouldntSetWindow => {
            "WindowOnly auf FALSE setzen, oder einen Antrieb nehmen, dessen Trigger ein Fenster hat"
        }
        E::AtTriggernotoccupied => {
            "nichts ist zu tun: MC_TouchProbe ist schon zu Ende, oder der Trigger ist ein anderer"
        }
        E::McaDirectionNotApplicable => {
            "eine andere Richtung als fastest angeben: die Achse hält am Ziel nicht an"
        }
        E::CrNoTappetsInCam => {
            "der Kurvenscheibe Nocken geben, oder die Kurvenscheibe übergeben, die welche hat"
        }
        E::CrTooManyTappets => {
            "die Gruppen der Nocken von 1 bis MAX_NUM_TAPPETS nummerieren, oder diese Konstante erhöhen"
        }
        E::CrMoreThan32Accesses => {
            "höchstens 32 Bausteine eine Kurvenscheibe verwenden lassen, oder sie für die übrigen kopieren"
        }
        E::CiNoCamSelected => {
            "MC_CamTableSelect aufrufen und seine CamTableID an MC_CamIn geben, sobald er Done zeigt"
        }
        E::CiMasterOutOfScale => {
            "den Master vor dem Start in den Bereich der Kurvenscheibe bringen, oder sie mit MasterAbsolute FALSE auswählen; auch MasterOffset und MasterScaling verschieben den Master"
        }
        E::CiRampinNeedsVelaccValues => {
            "VelocityDiff, Acceleration und Deceleration größer als 0 setzen, oder absolut oder relativ starten; `twin tune cam` findet sie"
        }
        E::CiScalingIncorrect => {
            "fEditorMasterMin und Max, fTableMasterMin und Max und denen des Slaves je zwei verschiedene Werte geben"
        }
        E::GiRatioDenom => "RatioDenominator auf einen anderen Wert als 0 setzen",
        E::GiInvalidAcc => "Acceleration größer als 0 setzen",
        E::GiInvalidDec => "Deceleration größer als 0 setzen",
        E::PhInvalidVelaccdec => "Velocity, Acceleration und Deceleration größer als 0 setzen",
        E::PhRotaryaxisPeriod0 => {
            "fPositionPeriod der rotatorischen Achsen auf ihre Periode setzen"
        }
        E::NoCamRefType => {
            "eine Variable vom Typ MC_CAM_REF übergeben, oder die Kurvenscheibe, die der Editor übersetzt hat"
        }
        E::GipMasterDirectionChange => {
            "den Master bis InSync in eine Richtung weiterfahren lassen, oder mit MasterStartDistance näher beginnen"
        }
        E::IntVelZero => {
            "der Bahn vor ihrem ersten Element eine Geschwindigkeit (F) größer als 0 geben, und einen Override über 0"
        }
        E::IntNoStopAtEnd => {
            "das letzte Element in Ruhe enden lassen: SMC_CheckVelocities als letzten Baustein vor dem Interpolator aufrufen"
        }
        E::IntDataUnderrun => {
            "den Bausteinen vor dem Interpolator mehr Zeit oder eine größere Queue geben, und bEndOfList hinter dem letzten Element setzen"
        }
        E::IntVelNonzeroAtStop | E::IntNoCheckvelocities => {
            "SMC_CheckVelocities als letzten Baustein vor dem Interpolator aufrufen"
        }
        E::IntTooManyRecursions | E::IntPathExceeded => {
            "das sollte nicht vorkommen: Programm und Eingänge des Bausteins aufbewahren und melden"
        }
        E::Int2dirBufferTooSmall
        | E::GcvBufferTooSmall
        | E::RncfBufferTooSmall
        | E::RncqBufferTooSmall => "dem Baustein einen größeren Puffer geben",
        E::Int2dirPathFitsNotInQueue => {
            "der Queue einen Puffer für die ganze Bahn geben, denn rückwärts braucht sie ganz, oder die Bahn kürzen"
        }
        E::WarIntOutqueueTooSmall => {
            "der Queue einen größeren Puffer geben: die Vorausschau muss über jeden Halt reichen"
        }
        E::WarEndVelocitiesIncorrect => {
            "SMC_CheckVelocities zuletzt aufrufen; Elemente verlangen Endgeschwindigkeiten, die ihre Längen nicht erlauben"
        }
        E::CvAccDecVelNonpositive => {
            "Geschwindigkeit (F), Beschleunigung (E) und Verzögerung (E-) ungleich 0 programmieren"
        }
        E::DecAccTooLittle => "eine Beschleunigung (E) größer als 0 programmieren",
        E::DecRetTooLittle => "eine Verzögerung (E-) kleiner als 0 programmieren",
        E::DecOutqueueRanEmpty => {
            "dem Decoder mehr Zeit geben, als der Interpolator braucht, oder eine größere Queue"
        }
        E::GcvBufferWrongType => "als Puffer ein ARRAY OF SMC_GCODE_TEXT übergeben",
        E::GcvUnknownIpoLine => {
            "dem Baustein dasselbe Programm geben, das der Interpolator ausführt, und einen Puffer, der die Zeilen voraus fasst"
        }
        E::NoCncRefType => "eine Variable vom Typ SMC_CNC_REF übergeben",
        E::NoOutqueueType => "einen Zeiger auf eine SMC_OUTQUEUE übergeben",
        E::RncfFileDoesntExist => {
            "Name und Ordner der Datei prüfen, und ob die Steuerung sie lesen darf"
        }
        E::RncfNoBuffer | E::RncqNoBuffer => "pBuffer und dwBufferSize angeben",
        E::RncfDataUnderrun => {
            "warten, bis die Datei weiter gelesen ist; sie in einer langsameren Task mit einem größeren Puffer lesen"
        }
        E::RncfVarCouldntBeReplaced => {
            "die Variable des Programms in die Liste aufnehmen, ihren Namen in Großbuchstaben"
        }
        E::RncfNotVarlist => "als pvl einen Zeiger auf eine SMC_VARLIST übergeben",
        E::RncqFileDoesntExist | E::AdlFileCannotBeOpened | E::RcamFileDoesntExist => {
            "Name und Ordner der Datei prüfen, und ob die Steuerung sie öffnen darf"
        }
        E::RncqUnexpectedEof | E::RcamUnexpectedEof => {
            "die Datei neu schreiben: sie ist abgeschnitten"
        }
        E::AdlBufferOverrun => {
            "die Aktion WriteToFile öfter aufrufen, oder weniger Werte aufzeichnen"
        }
        E::RcamTooMuchData => {
            "gc_SMC_FILE_MAXCAMEL und gc_SMC_FILE_MAXCAMTAP erhöhen, oder die Kurvenscheibe ausdünnen (`twin cam convert --tolerance`)"
        }
        E::RcamWrongCompileType => {
            "die Kurvenscheibe so übersetzen, wie der Baustein sie erwartet, oder ihm eine der anderen Art geben"
        }
        E::RcamWrongVersion => "die Datei mit dieser Version neu schreiben",
        E::WdpfChannelOccupied => "warten, bis der andere Baustein seine Parameter gelesen hat",
        E::WdpfCannotCreateFile => {
            "Name und Ordner der Datei prüfen, und ob die Steuerung dort schreiben darf"
        }
        E::WdpfErrorWhenReadingParams | E::WdpfTimeoutPreparingList => {
            "prüfen, ob der Antrieb versorgt und seine Leitung in Ordnung ist, und ob er die Parameter der Liste hat"
        }
        E::EncDenomZero => "dwRatioTechUnitsDenom des Gebers auf einen anderen Wert als 0 setzen",
        E::EncAxisusedbyotherfb => {
            "eine andere Achse bewegen: die eines Gebers folgt nur dem, was er misst"
        }
    }
}
