//! The texts in French.

use super::SmcError as E;

/// What an error means.
#[expect(clippy::too_many_lines, reason = "a table, one line an error")]
pub(super) const fn text(error: E) -> &'static str {
    match error {
        E::NoError => "pas d'erreur",
        E::DiGeneralCommunicationError => {
            "communication avec l'entraînement rompue, par exemple anneau ouvert"
        }
        E::DiSwlimitsExceeded => "position en dehors des limites logicielles",
        E::RegulatorOrStartNotSet => "régulateur non validé ou frein serré",
        E::FbWasntCalledDuringMotion => {
            "un bloc qui déplace l'axe n'a plus été appelé avant la fin du mouvement"
        }
        E::AxisIsNoAxisRef => "la variable donnée comme axe n'est pas une AXIS_REF",
        E::AxisRefChangedDuringOperation => {
            "un autre axe a été donné pendant que le bloc travaillait"
        }
        E::HomingInvalidVelaccValues
        | E::MsInvalidAccdecValues
        | E::MaInvalidVelaccValues
        | E::MrInvalidVelaccValues
        | E::MadInvalidVelaccValues
        | E::MsiInvalidVelaccValues
        | E::MvInvalidAccdecValues
        | E::McrInvalidVelaccValues
        | E::McaInvalidVelaccValues => "vitesse ou accélération incorrecte",
        E::HomingModeNeedsHwlimit => "ce mode de référencement exige les fins de course",
        E::ScmNotSupported => "mode de régulation non supporté par l'entraînement",
        E::StWrongControllerMode => "l'axe n'est pas dans le bon mode de régulation",
        E::RagErrorDuringStartup => "erreur au lancement du groupe d'axes",
        E::CgrZeroValues => "une valeur est nulle et ne doit pas l'être",
        E::CgrDrivePowered => "impossible tant que l'entraînement est régulé",
        E::PFtaskcycleEmpty => "l'axe n'a pas de temps de cycle",
        E::RNoErrorToReset => "l'axe n'a pas d'erreur à réinitialiser",
        E::RDriveDoesntAnswer => "l'entraînement ne réinitialise pas l'erreur",
        E::RErrorNotResettable => "l'erreur ne peut pas être réinitialisée",
        E::RDriveDoesntAnswerInTime => "l'entraînement n'a pas répondu à temps",
        E::RpParamUnknown => "numéro de paramètre inconnu",
        E::RpRequestingError => "échec de la lecture du paramètre dans l'entraînement",
        E::WpParamInvalid => "numéro de paramètre inconnu ou écriture interdite",
        E::WpSendingError => "échec de l'écriture du paramètre dans l'entraînement",
        E::HAxisWasntStandstill => "l'axe n'était pas à l'arrêt",
        E::HAxisDidntStartHoming => "l'entraînement n'a pas commencé la course de référence",
        E::HAxisDidntAnswer => "l'entraînement n'a pas répondu",
        E::HErrorWhenStopping => {
            "échec de l'arrêt après la course de référence ; une décélération est-elle définie ?"
        }
        E::MsUnknownStoppingError => "échec de l'arrêt pour une raison inconnue",
        E::MsDirectionNotApplicable | E::MvDirectionNotApplicable => {
            "la direction la plus courte n'est pas applicable ici"
        }
        E::MsAxisInErrorstop => "l'axe est en errorstop et ne peut pas être arrêté",
        E::MaInvalidDirection
        | E::MrInvalidDirection
        | E::MadInvalidDirection
        | E::MsiInvalidDirection
        | E::McrInvalidDirection
        | E::McaInvalidDirection => "direction incorrecte",
        E::PpArraysize | E::VpArraysize | E::ApArraysize => "nombre de points incorrect",
        E::PpStep0ms | E::VpStep0ms | E::ApStep0ms => "un pas du profil a une durée nulle",
        E::TpTriggeroccupied => "le déclencheur est déjà utilisé",
        E::TpCouldntSetWindow => "l'entraînement ne supporte pas de fenêtre pour le déclencheur",
        E::TpCommError => "échec de la communication avec l'entraînement",
        E::AtTriggernotoccupied => "le déclencheur n'est pas utilisé",
        E::McaDirectionNotApplicable => "la direction la plus rapide n'est pas applicable ici",
        E::CrNoTappetsInCam => "la came n'a pas de taquets",
        E::CrTooManyTappets => "le numéro de groupe d'un taquet dépasse le maximum",
        E::CrMoreThan32Accesses => "plus de 32 accès à la came",
        E::CiNoCamSelected => "pas de came sélectionnée",
        E::CiMasterOutOfScale => "l'axe maître est en dehors de la plage de la came",
        E::CiRampinNeedsVelaccValues => "ramp_in exige une vitesse et une accélération",
        E::CiScalingIncorrect => "la graduation du maître dans la came est incorrecte",
        E::GiRatioDenom => "le dénominateur du rapport est 0",
        E::GiInvalidAcc | E::DecAccTooLittle => "accélération incorrecte",
        E::GiInvalidDec | E::DecRetTooLittle => "décélération incorrecte",
        E::PhInvalidVelaccdec => "vitesse, accélération ou décélération incorrecte",
        E::PhRotaryaxisPeriod0 => "axe rotatif de période 0",
        E::NoCamRefType => "la variable donnée comme came n'en est pas une",
        E::GipMasterDirectionChange => "le maître a changé de direction pendant le couplage",
        E::IntVelZero => "trajectoire impraticable : la vitesse de consigne est 0",
        E::IntNoStopAtEnd => "le dernier objet de la trajectoire ne finit pas à l'arrêt",
        E::IntDataUnderrun => "la trajectoire est épuisée avant que sa fin soit annoncée",
        E::IntVelNonzeroAtStop => "la vitesse à un point d'arrêt n'est pas 0",
        E::IntTooManyRecursions => "erreur interne : trop de récursions",
        E::IntNoCheckvelocities => {
            "les vitesses de la trajectoire n'ont pas été contrôlées en dernier"
        }
        E::IntPathExceeded => "erreur interne : fin de la trajectoire dépassée",
        E::Int2dirBufferTooSmall
        | E::GcvBufferTooSmall
        | E::RncfBufferTooSmall
        | E::RncqBufferTooSmall => "mémoire tampon trop petite",
        E::Int2dirPathFitsNotInQueue => "la trajectoire n'est pas complètement dans la file",
        E::WarIntOutqueueTooSmall => "avertissement : file trop petite pour garantir chaque arrêt",
        E::WarEndVelocitiesIncorrect => "avertissement : vitesses finales contradictoires",
        E::CvAccDecVelNonpositive => "vitesse, accélération ou décélération non positive",
        E::DecOutqueueRanEmpty => "la file s'est vidée",
        E::GcvBufferWrongType => "les éléments de la mémoire tampon sont d'un type incorrect",
        E::GcvUnknownIpoLine => "la ligne de l'interpolateur est introuvable",
        E::NoCncRefType => "la variable donnée comme programme n'est pas un programme CNC",
        E::NoOutqueueType => "la variable donnée comme file n'en est pas une",
        E::RncfFileDoesntExist => "le fichier n'existe pas",
        E::RncfNoBuffer | E::RncqNoBuffer => "pas de mémoire tampon",
        E::RncfDataUnderrun => "la mémoire tampon a été entièrement lue",
        E::RncfVarCouldntBeReplaced => "une variable du programme n'a pas pu être remplacée",
        E::RncfNotVarlist => "la liste de variables n'en est pas une",
        E::RncqFileDoesntExist | E::AdlFileCannotBeOpened | E::RcamFileDoesntExist => {
            "impossible d'ouvrir le fichier"
        }
        E::RncqUnexpectedEof | E::RcamUnexpectedEof => "fin de fichier inattendue",
        E::AdlBufferOverrun => {
            "débordement de la mémoire tampon ; écrire plus souvent dans le fichier"
        }
        E::RcamTooMuchData => "la came enregistrée est trop grande",
        E::RcamWrongCompileType => "la came enregistrée est d'un autre mode de compilation",
        E::RcamWrongVersion => "le fichier a une autre version",
        E::WdpfChannelOccupied => "le canal de lecture des paramètres est occupé",
        E::WdpfCannotCreateFile => "impossible de créer le fichier",
        E::WdpfErrorWhenReadingParams => "échec de la lecture des paramètres",
        E::WdpfTimeoutPreparingList => "la liste des paramètres n'a pas été prête à temps",
        E::EncDenomZero => "le dénominateur du rapport de l'encodeur est 0",
        E::EncAxisusedbyotherfb => "un bloc déplace l'axe d'un encodeur",
    }
}
